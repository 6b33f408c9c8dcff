// Where pages lie on a board of cells: those of one sheet, which share strips, and single ones.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/pack/first_fit.h"
#include "devseg/pack/separation.h"
#include "sheet/layout.h"
#include "sheet/page_cover.h"

namespace devseg::sheet {

/// mm between cut lines and the border of the printable area.
constexpr double border_clearance = 0.5;

/// All that is the same for every layout of the pieces.
struct PageProblem {
    PageFormat page;
    double cell = 1.0; // mm
    Index factor = 1;  // cells that make a coarse one, to a side
    Index columns = 0; // cells that a piece with its margin may take on one page
    Index rows = 0;
    std::vector<pack::Outline> outlines;
    std::vector<std::vector<pack::FitImage>> poses;
    std::vector<std::uint8_t> is_large; // fits on no page
    std::vector<double> area;           // mm², of the cut line
    double material = 0.0;              // mm², inside all cut lines

    double page_area() const { return page.printable().prod(); }
};

struct PageCover {
    std::vector<Index> owner; // of each part of the sheet: the page that prints it, −1: none
    std::vector<Index> cells; // on each page, 0: it is not printed
};

/// A sheet of pages in columns and rows, from the lower left; above it single pages, side by side.
/// Large pieces lie anywhere on the sheet, others on one page, clear of the strips. Cells are
/// `factor` times as wide as the problem's: then windows are rounded, and else nothing lies on a
/// part that only seems to be shown.
class PageGrid {
public:
    PageGrid(const PageProblem& problem, Index columns, Index rows, Index singles, Index factor);

    Index columns() const { return columns_; }
    Index rows() const { return rows_; }
    Index glued() const { return columns_ * rows_; }
    Index pages() const { return glued() + singles_; }
    /// What a page of the sheet shows.
    pack::Window shown(Index page) const;
    /// What no other page of the sheet shows.
    pack::Window own(Index page) const;
    /// Where pieces lie that fit on a page.
    pack::Window clear(Index page) const;
    pack::Window sheet() const;
    /// All that no open page shows, on the sheet and around it: no piece lies there.
    pack::ChartCells closed(const std::vector<std::uint8_t>& is_open, pack::Spot& spot) const;
    /// Where each piece may lie: small ones on one open page, large ones within the sheet's open
    /// part. The last window is that of what is closed.
    std::vector<std::vector<pack::Window>> windows(const std::vector<std::uint8_t>& is_open,
                                                   const pack::ChartCells& closed,
                                                   const pack::Spot& spot) const;
    /// The page that shows all of the image; −1: none.
    Index page_of(const pack::ChartCells& image, const pack::Spot& spot) const;
    /// Adds the cells of the image on each part of the sheet (page_cover.h), where it lies.
    void count(const pack::ChartCells& image, const pack::Spot& spot,
               std::vector<Index>& parts) const;
    /// Without any cells yet.
    std::vector<Index> empty_parts() const {
        return std::vector<Index>(at(parts_of(columns_) * parts_of(rows_)), 0);
    }
    /// What is printed where, of pieces with these images and places.
    PageCover cover(const std::vector<const pack::ChartCells*>& images,
                    const pack::Layout& spots) const;
    /// How many pages of the sheet an image needs there by itself.
    Index least_pages(const pack::ChartCells& image, const pack::Spot& spot) const;
    /// The pages that an image is printed on, ascending.
    std::vector<Index> pages_of(const pack::ChartCells& image, const pack::Spot& spot,
                                const PageCover& cover) const;

private:
    std::vector<Index> part_starts(Index pages, int axis) const;
    std::array<Index, 2> clear_range(Index page, Index pages, int axis) const;
    pack::Window coarse(const pack::Window& fine) const;

    const PageProblem* problem_;
    Index columns_;
    Index rows_;
    Index singles_;
    Index factor_;
    std::array<std::vector<Index>, 2>
        starts_; // of parts, along x and y, and where the last one ends
};

} // namespace devseg::sheet
