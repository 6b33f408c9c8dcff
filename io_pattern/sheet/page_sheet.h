// One sheet that is being filled with pieces: pages in columns and rows that share strips.
#pragma once

#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "devseg/pack/first_fit.h"
#include "sheet/page_footprints.h"

namespace devseg::sheet {

/// Pages in columns, and in as many rows as pieces need.
class PageSheet {
public:
    /// `work` counts cells that are compared and set.
    PageSheet(const PageProblem& problem, Index columns, std::int64_t& work)
        : problem_(&problem), work_(&work), columns_(columns),
          cells_(problem.columns + problem.cells_down((columns - 1) * problem.page.step().x()),
                 problem.longest_run) {}

    Index columns() const { return columns_; }
    /// Cells that pieces cover on each page, row by row from below; 0 = nobody prints it.
    const std::vector<Index>& covered() const { return covered_; }
    double area() const { return area_; }
    Index page_count() const;

    /// Whether something of the image lies on the page.
    bool is_on(const pack::FitImage& image, const pack::Spot& spot, Index page) const;

    /// The lowest place for a piece in one of some poses on one page.
    std::optional<pack::Spot> place_on_page(const std::vector<pack::FitImage>& poses,
                                            const std::vector<std::size_t>& chosen, Index page);

    /// A place for a large piece, among those that are known, that takes fewer new pages than
    /// `limit`; then `limit` is what it takes.
    std::optional<pack::Spot> place_large(const std::vector<pack::FitImage>& poses,
                                          const std::vector<Footprint>& footprints,
                                          std::minstd_rand& random, Index& limit);

    void take(const pack::FitImage& image, const pack::Spot& spot, double area);

    /// Columns and rows with nothing on them, at the left and below.
    PageSpot empty_margin() const;
    /// Without them.
    PatternSheet result() const;

private:
    Index new_pages(const pack::FitImage& image, const pack::Spot& spot) const;
    pack::Spot slid(const pack::FitImage& image, pack::Spot spot, std::minstd_rand& random) const;
    Index rows() const { return static_cast<Index>(covered_.size()) / columns_; }
    bool is_used(Index page) const {
        return page < static_cast<Index>(covered_.size()) && covered_[at(page)] != 0;
    }

    const PageProblem* problem_;
    std::int64_t* work_;
    Index columns_;
    pack::FreeCells cells_;
    std::vector<Index> covered_;
    double area_ = 0.0;
};

} // namespace devseg::sheet
