// Pieces on a board of pages while a search moves them.
#pragma once

#include <optional>
#include <random>
#include <vector>

#include "sheet/page_grid.h"
#include "sheet/page_places.h"

namespace devseg::sheet {

/// The images of a piece on coarse cells.
struct BoardPiece {
    std::vector<pack::FitImage> images;
    std::vector<Reach> reaches; // of each image, into a page; empty for pieces that fit on one
};

BoardPiece board_piece(const PageProblem& problem, std::size_t piece, double enough);

/// Numbers that are the same everywhere.
class Dice {
public:
    explicit Dice(std::uint64_t seed)
        : random_(static_cast<std::minstd_rand::result_type>(seed + 1)) {}
    std::size_t below(std::size_t count) { return random_() % count; }
    bool coin() { return below(2) == 0; }

private:
    std::minstd_rand random_;
};

class PageBoard {
public:
    /// All outlive it. The board has a single page for each piece that fits on one.
    PageBoard(const PageProblem& problem, const std::vector<BoardPiece>& pieces, Index columns,
              Index rows);

    const PageGrid& grid() const { return grid_; }
    const pack::Layout& spots() const { return spots_; }
    void take_out(std::size_t piece) { is_there_[piece] = 0; }
    void lay(std::size_t piece, const pack::Spot& spot);
    /// The cells of all that is there, on each page as it is printed.
    std::vector<Index> covered() const;
    /// Those that the page is needed for.
    std::vector<std::size_t> pieces_on(Index page) const;

    /// Of all free places of some images of the piece, one that is printed on the fewest new pages,
    /// and of those on the fewest in all. `closed`: a page that it may not need, or −1. Nothing
    /// where there is none. Subtracts its work, in words of bits.
    std::optional<pack::Spot> find_place(std::size_t piece, const std::vector<std::size_t>& images,
                                         Index closed, Dice& dice, double& work) const;

private:
    struct Row;
    pack::FreeCells taken(Index closed) const;
    bool allow(std::size_t piece, const pack::ChartCells& image, Index closed,
               const std::vector<Index>& covered, Row& row) const;
    void count_pages(const Reach& reach, const std::vector<Index>& covered, Row& row,
                     double& work) const;

    const PageProblem* problem_;
    const std::vector<BoardPiece>* pieces_;
    PageGrid grid_;
    Index width_ = 0; // cells
    Index height_ = 0;
    Index longest_run_ = 1;
    std::vector<pack::Window> own_;   // of each page of the sheet
    std::vector<pack::Window> clear_; // of each page
    pack::Layout spots_;
    std::vector<std::uint8_t> is_there_;
    std::vector<Index> page_;               // single page, or −1: on the sheet
    std::vector<std::vector<Index>> parts_; // of the sheet, cells of each piece there
};

} // namespace devseg::sheet
