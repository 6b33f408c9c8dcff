// Which pages a piece needs, by where it lies among them.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "devseg/pack/first_fit.h"
#include "sheet/layout.h"

namespace devseg::sheet {

/// mm between cut lines and the border of the printable area.
constexpr double border_clearance = 0.5;

/// The page of a sheet: its column and its row from below.
using PageSpot = std::array<Index, 2>;

/// Where a large piece lies, as seen from the corner of the first of its pages.
struct PagePlace {
    std::size_t pose = 0;
    Vec2 offset = Vec2::Zero(); // mm
};

/// The same pages, for many places of a piece.
struct Footprint {
    std::vector<PageSpot> pages; // from the lower left of all
    Index across = 1;            // columns
    Index up = 1;                // rows
    // The piece lies in the strip that a page before would show: there is none before.
    std::array<bool, 2> at_border{};
    std::vector<PagePlace> places;
};

/// All that is the same for every order of the pieces.
struct PageProblem {
    PageFormat page;
    double cell = 1.0; // mm
    Index columns = 0; // cells that a piece with its margin may take on one page
    Index rows = 0;
    std::vector<std::vector<pack::FitImage>> poses;
    std::vector<std::vector<Footprint>> footprints; // of large pieces, fewest pages first
    std::vector<std::uint8_t> is_large;
    std::vector<double> area; // mm², of the cut line
    Index longest_run = 1;

    Index cells_down(double mm) const { return static_cast<Index>(std::floor(mm / cell + 1e-9)); }
    Index cells_up(double mm) const { return static_cast<Index>(std::ceil(mm / cell - 1e-9)); }
    double page_area() const { return page.printable().prod(); }
    /// Cells of one page.
    double page_cells() const { return page_area() / (cell * cell); }
    /// The place of an offset, `column` and `row` pages further.
    pack::Spot spot_of(const PagePlace& place, Index column, Index row) const {
        const Vec2 low = place.offset + Vec2(column, row).cwiseProduct(page.step());
        return {place.pose, cells_up(low.x()), cells_up(low.y())};
    }
};

/// The pages that an image needs where it lies, and how many of its cells lie on each.
std::vector<std::pair<PageSpot, Index>>
pages_of(const PageProblem& problem, const pack::ChartCells& image, const pack::Spot& spot);

/// Where one piece needs the fewest pages, or hardly more, of places all over a page.
std::vector<Footprint> find_footprints(const PageProblem& problem,
                                       const std::vector<pack::FitImage>& poses);

} // namespace devseg::sheet
