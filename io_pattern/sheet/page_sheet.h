// One sheet that is being filled with pieces: pages in columns and rows that share strips.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "devseg/pack/first_fit.h"
#include "sheet/layout.h"

namespace devseg::sheet {

/// mm between cut lines and the border of the printable area.
constexpr double border_clearance = 0.5;

/// A large piece in one pose, so far from the corner of the first of its pages: what it needs.
struct Footprint {
    std::size_t pose = 0;
    Vec2 offset = Vec2::Zero();              // mm
    std::array<bool, 2> at_border{};         // lies in the strip that a page before would show
    std::vector<std::array<Index, 2>> pages; // columns and rows, 0 = the first
    Index across = 1;                        // columns of pages
};

/// All that is the same for every order of the pieces.
struct PageProblem {
    PageFormat page;
    double cell = 1.0; // mm
    Index columns = 0; // cells that a piece with its margin may take on one page
    Index rows = 0;
    std::vector<std::vector<pack::FitImage>> poses;
    std::vector<std::vector<Footprint>> footprints; // of large pieces
    std::vector<std::uint8_t> is_large;
    std::vector<double> area; // mm², of the cut line
    Index longest_run = 1;

    Index cells_down(double mm) const { return static_cast<Index>(std::floor(mm / cell + 1e-9)); }
    Index cells_up(double mm) const { return static_cast<Index>(std::ceil(mm / cell - 1e-9)); }
    double page_area() const { return page.printable().prod(); }
};

/// Where one piece needs the fewest pages, or hardly more, of places all over a page. None for
/// pieces of very many pages, which have little to gain.
std::vector<Footprint> find_footprints(const PageProblem& problem,
                                       const std::vector<pack::FitImage>& poses);

/// Pages in columns, and in as many rows as pieces need.
class PageSheet {
public:
    PageSheet(const PageProblem& problem, Index columns, std::int64_t& work)
        : problem_(&problem), work_(&work), columns_(columns),
          cells_(problem.columns + problem.cells_down((columns - 1) * problem.page.step().x()),
                 problem.longest_run) {}

    Index rows() const { return static_cast<Index>(covered_.size()) / columns_; }
    Index page_count() const {
        return static_cast<Index>(covered_.size()) -
               static_cast<Index>(std::count(covered_.begin(), covered_.end(), 0));
    }
    double area() const { return area_; }
    /// Cells that are covered on the page with the fewest, of those in use.
    Index fewest_cells() const {
        Index least = std::numeric_limits<Index>::max();
        for (const Index cells : covered_)
            least = cells > 0 ? std::min(least, cells) : least;
        return least;
    }

    Index columns() const { return columns_; }
    /// Whether a piece of the sheet lies on its page with the fewest cells.
    bool needs_emptiest(const pack::FitImage& image, const pack::Spot& spot) const;
    /// Pages in use with fewer cells than that on them.
    Index pages_below(Index least) const {
        return static_cast<Index>(std::count_if(covered_.begin(), covered_.end(), [&](Index cells) {
            return cells > 0 && cells < least;
        }));
    }

    /// The best place for a piece in one of some poses on one page that is in use.
    bool put_on_page(const std::vector<pack::FitImage>& poses,
                     const std::vector<std::size_t>& chosen, pack::Spot& spot);

    struct LargePlace {
        pack::Spot spot;
        Index new_pages = 0;
        Index top = 0;
        bool found = false;

        bool is_better_than(const LargePlace& other) const {
            return found && (!other.found ||
                             std::pair(new_pages, top) < std::pair(other.new_pages, other.top));
        }
    };

    /// The place of a piece in one of some poses, on one page or several, that takes the fewest new
    /// pages. `random`: where in its pages the piece lies; none: at the lower left.
    LargePlace place_of(const std::vector<pack::FitImage>& poses,
                        const std::vector<std::size_t>& chosen,
                        const std::vector<Footprint>& footprints, std::minstd_rand* random);

    void take(const pack::FitImage& image, const pack::Spot& spot, double area);

    /// Pages that a piece of so many cells needs in one direction.
    static Index pages_for(Index cells, Index first, double step_cells) {
        return cells <= first
                   ? 1
                   : 1 + static_cast<Index>(std::ceil((cells - first) / step_cells - 1e-9));
    }

    PatternSheet result() const;

private:
    // A part of the room that there is: none, all or something between.
    static Index part(std::uint_fast32_t random, Index room) {
        constexpr Index parts = 4;
        return room * static_cast<Index>(random % (parts + 1)) / parts;
    }

    bool find(const pack::FitImage& image, const pack::FitWindow& window, pack::Spot& spot);

    void look(const std::vector<pack::FitImage>& poses, std::size_t pose,
              const pack::FitWindow& window, LargePlace& best);

    bool is_used(Index page) const {
        return page < static_cast<Index>(covered_.size()) && covered_[at(page)] != 0;
    }
    double step(int axis) const { return problem_->page.step()[axis] / problem_->cell; }

    // Pages that lie side by side, as one.
    pack::FitWindow block(Index column, Index row, Index across, Index up) const;

    // One page without the strips that it shares.
    pack::FitWindow inner_window(Index column, Index row) const;

    // Places that need few pages by themselves, as far as they need fewer new ones here.
    void look_at(const std::vector<pack::FitImage>& poses, const std::vector<Footprint>& footprints,
                 std::minstd_rand* random, LargePlace& best);

    const PageProblem* problem_;
    std::int64_t* work_;
    Index columns_;
    pack::FreeCells cells_;
    std::vector<Index> covered_; // #pages, row by row from below: cells
    double area_ = 0.0;
};

} // namespace devseg::sheet
