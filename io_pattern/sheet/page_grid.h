// Where pages lie on a board of cells: those of one sheet, which share strips, and single ones.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/pack/first_fit.h"
#include "sheet/layout.h"

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

    double page_area() const { return page.printable().prod(); }
};

/// A sheet of pages in columns and rows, from the lower left; above it single pages, side by side.
/// Large pieces lie anywhere on the sheet, others on one page, clear of the strips. Cells are
/// `factor` times as wide as the problem's: then windows are rounded, and else nothing that needs a
/// page is outside of its part.
class PageGrid {
public:
    PageGrid(const PageProblem& problem, Index columns, Index rows, Index singles, Index factor);

    Index columns() const { return columns_; }
    Index rows() const { return rows_; }
    Index glued() const { return columns_ * rows_; }
    Index pages() const { return glued() + singles_; }
    /// Of a page in the sheet: what no page before it shows (own_part).
    pack::Window own(Index page) const;
    /// Where pieces lie that fit on a page.
    pack::Window clear(Index page) const;
    pack::Window sheet() const;
    /// All of the sheet and around it but some of its pages: no piece lies there.
    pack::ChartCells closed(const std::vector<std::uint8_t>& is_open, pack::Spot& spot) const;
    /// Cells of the image on each page of the sheet, where it lies.
    void count(const pack::ChartCells& image, const pack::Spot& spot,
               std::vector<Index>& cells) const;

private:
    std::array<Index, 2> own_range(Index page, Index pages, int axis) const;
    std::array<Index, 2> clear_range(Index page, Index pages, int axis) const;
    pack::Window coarse(const pack::Window& fine) const;

    const PageProblem* problem_;
    Index columns_;
    Index rows_;
    Index singles_;
    Index factor_;
};

} // namespace devseg::sheet
