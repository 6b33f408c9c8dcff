// References
//   S. Umetani, M. Yagiura, S. Imahori, T. Imamichi, K. Nonobe, T. Ibaraki: "Solving the irregular
//   strip packing problem via guided local search for overlap minimization", International
//   Transactions in Operational Research 16(6), 2009, doi:10.1111/j.1475-3995.2009.00707.x
//   J. Gardeyn, G. Vanden Berghe, T. Wauters: "An open-source heuristic to reboot 2D nesting
//   research", 2025, arXiv:2509.13329: the length shrinks by steps that get smaller.
#include "devseg/pack/strip.h"

#include <algorithm>
#include <cmath>

#include "devseg/base/parallel.h"
#include "devseg/pack/compaction.h"
#include "devseg/pack/separation.h"

namespace devseg::pack {

namespace {

struct Tuning {
    // Cells along the side of a square that holds all items: on the coarse grid, by the root of
    // their number over the usual one, and on the fine grid.
    double coarse_cells = 110.0;
    double usual_items = 20.0;
    double most_coarse_cells = 400.0;
    double finer = 6.0;      // cells of the fine grid in one of the coarse one
    Index supersampling = 4; // cells that decide on one coarse cell, to a side
    double use = 0.8;        // share of that square that items cover
    int turns = 32;          // of items that may turn as they like
    double fine_turn = 1.5 * pi / 180.0;
    int fine_turns = 2; // to each side
    // Shrinking: the first step as a share of the length, the work in cell operations of one
    // attempt and of all, and when steps become smaller.
    double first_step = 0.05;
    double attempt_work = 4.0e8;
    double coarse_work = 4.0e9;
    double fine_attempt_work = 2.0e8;
    double fine_work = 2.0e9;
    std::uint64_t searches = 8; // on the coarse grid
    int patience = 60;          // rounds without progress
    int fine_patience = 40;
    Index fine_reach = 9;   // cells
    int failures = 3;       // at one step, before it is halved
    int last_failures = 24; // at a step of one cell, before the end
    double attempt_overhead = 2.0e6;
    // Until the fine grid holds the layout: its length grows, with so much work each time.
    double grown = 1.006;
    double separating_work = 1.5e8;
    int attempts = 16;
};
constexpr Tuning tuning;

struct Strip {
    std::vector<ChartPoses> poses;
    double cell = 1.0;
    Layout layout;
    Frame frame;
};

std::vector<double> angles_of(const StripItem& item, int turns) {
    if (!item.angles.empty())
        return item.angles;
    std::vector<double> angles;
    const double base = best_box_angle(item.outline);
    for (int k = 0; k < turns; ++k)
        angles.push_back(base + 2.0 * pi * k / turns);
    return angles;
}

double width_at(const Outline& outline, double angle) {
    const Placement turn{std::cos(angle), std::sin(angle), Vec2::Zero()};
    return plane::box_of(outline.hull, turn).sizes().x();
}

Index columns_of(const StripOptions& options, double cell) {
    // Half of the gap around each item may lie outside.
    return static_cast<Index>(std::floor((options.width + options.gap) / cell));
}

Index used_height(const std::vector<ChartPoses>& poses, const Layout& layout) {
    Index top = 0;
    for (std::size_t i = 0; i < layout.size(); ++i)
        top = std::max(top, layout[i].y + poses[i][layout[i].pose].height);
    return top;
}

// Images are up to two cells wider than their items: those of items as wide as the strip lose
// columns at their sides.
void crop(Index columns, double cell, bool keep_left, ChartCells& image) {
    const Index extra = image.width - columns;
    if (extra <= 0)
        return;
    const Index left = keep_left ? 0 : extra / 2;
    const auto cropped = [&](CellRun& run) {
        run.first = std::max(Index{0}, run.first - left);
        run.last = std::min(columns, run.last - left);
        return run.first < run.last;
    };
    image.count = 0;
    for (CellRun& run : image.runs)
        image.count += cropped(run) ? run.last - run.first : 0;
    const auto is_empty = [](const CellRun& run) { return run.first >= run.last; };
    image.runs.erase(std::remove_if(image.runs.begin(), image.runs.end(), is_empty),
                     image.runs.end());
    for (WeightedRun& run : image.obstacle)
        cropped(run.cells);
    image.obstacle.erase(
        std::remove_if(image.obstacle.begin(), image.obstacle.end(),
                       [&](const WeightedRun& run) { return is_empty(run.cells); }),
        image.obstacle.end());
    image.width = columns;
    image.offset.x() -= left * cell;
}

// Of all items one above the other.
Index total_height(const std::vector<ChartPoses>& poses) {
    Index total = 0;
    for (const ChartPoses& item : poses)
        total += std::max_element(
                     item.begin(), item.end(),
                     [](const ChartCells& p, const ChartCells& q) { return p.height < q.height; })
                     ->height;
    return total;
}

class StripSearch {
public:
    StripSearch(const std::vector<StripItem>& items, const StripOptions& options,
                Progress& progress)
        : items_(items), options_(options), progress_(progress) {
        double area = 0.0;
        for (const StripItem& item : items) {
            at_left_.push_back(item.at_left ? 1 : 0);
            area += item.outline.area;
        }
        const double crowd = std::max(1.0, static_cast<double>(items.size()) / tuning.usual_items);
        const double cells =
            std::min(tuning.most_coarse_cells, tuning.coarse_cells * std::sqrt(crowd));
        coarse_cell_ = std::min(std::sqrt(area / tuning.use) / cells, options.width / 8.0);
    }

    StripResult run() {
        const Strip first = begin();
        Strip strip = search(first);
        refine(strip);
        std::vector<Placement> placements(items_.size());
        for (std::size_t i = 0; i < items_.size(); ++i) {
            placements[i] =
                placement_of(strip.poses[i][strip.layout[i].pose], strip.layout[i], strip.cell);
            placements[i].offset -= Vec2::Constant(0.5 * options_.gap);
        }
        return finish(std::move(placements));
    }

private:
    // The first layout: piece by piece at the lowest free place.
    Strip begin() {
        auto drawing = progress_.part(0.1);
        Strip strip;
        strip.cell = coarse_cell_;
        strip.poses.resize(items_.size());
        const Index columns = columns_of(options_, strip.cell);
        parallel_for(
            static_cast<int>(items_.size()),
            [&](int i) {
                const StripItem& item = items_[at(i)];
                for (const double angle : angles_of(item, tuning.turns)) {
                    if (width_at(item.outline, angle) > options_.width)
                        continue;
                    ChartCells cells =
                        coarsen(rasterize(item.outline, angle, strip.cell / tuning.supersampling,
                                          0.5 * options_.gap),
                                tuning.supersampling);
                    crop(columns, strip.cell, item.at_left, cells);
                    strip.poses[at(i)].push_back(std::move(cells));
                }
            },
            drawing);
        strip.frame.width = columns;
        strip.frame.height = total_height(strip.poses);
        Separation separation(strip.poses, 0, progress_, at_left_);
        strip.layout = separation.fit_all(by_size(strip.poses), strip.frame);
        strip.frame.height = used_height(strip.poses, strip.layout);
        return strip;
    }

    // The shortest of what several searches find, as far as the work goes.
    Strip search(const Strip& first) {
        auto searching = progress_.part(0.5);
        const auto all = static_cast<std::int64_t>(options_.effort * tuning.coarse_work);
        std::int64_t budget = all;
        Strip best = first;
        for (std::uint64_t seed = 1; seed <= tuning.searches && budget > 0; ++seed) {
            Strip strip = first;
            shrink(strip, {0, 8, tuning.patience}, tuning.attempt_work, budget, seed);
            if (strip.frame.height < best.frame.height)
                best = std::move(strip);
            searching.update(1.0 - static_cast<double>(std::max<std::int64_t>(budget, 0)) /
                                       static_cast<double>(all));
        }
        return best;
    }

    // Subtracts from the budget what it took.
    void shrink(Strip& strip, const SeparationOptions& moves, double attempt, std::int64_t& budget,
                std::uint64_t seed) const {
        Separation separation(strip.poses, seed, progress_, at_left_);
        double step = tuning.first_step;
        int failures = 0;
        while (budget > 0) {
            const auto cells =
                std::max(Index{1}, static_cast<Index>(std::lround(step * strip.frame.height)));
            const Frame next{strip.frame.width, strip.frame.height - cells};
            if (cells == 1 && !separation.fits(next))
                break; // as high as its highest item
            std::int64_t work = std::min(budget, static_cast<std::int64_t>(attempt));
            const std::int64_t before = work;
            Layout layout = strip.layout;
            const bool found = separation.run(layout, next, moves, work);
            budget -= before - work + static_cast<std::int64_t>(tuning.attempt_overhead);
            if (found) {
                strip.layout = std::move(layout);
                strip.frame.height = used_height(strip.poses, strip.layout);
                failures = 0;
            } else if (++failures >= (cells > 1 ? tuning.failures : tuning.last_failures)) {
                step *= 0.5;
                failures = 0;
                if (cells == 1)
                    break; // the least step there is
            }
        }
    }

    // The same layout on the fine grid, whose images are conservative.
    void refine(Strip& strip) {
        auto drawing = progress_.part(0.1);
        const double cell = strip.cell / tuning.finer;
        Strip fine;
        fine.cell = cell;
        fine.poses.resize(items_.size());
        fine.layout = strip.layout;
        fine.frame.width = columns_of(options_, cell);
        parallel_for(
            static_cast<int>(items_.size()),
            [&](int k) {
                const std::size_t i = at(k);
                const ChartCells& coarse = strip.poses[i][strip.layout[i].pose];
                const double angle = std::atan2(coarse.sine, coarse.cosine);
                std::vector<double> angles = items_[i].angles;
                for (int t = -tuning.fine_turns; t <= tuning.fine_turns && items_[i].angles.empty();
                     ++t)
                    angles.push_back(angle + t * tuning.fine_turn);
                for (const double turn : angles) {
                    ChartCells cells = rasterize(items_[i].outline, turn, cell, 0.5 * options_.gap);
                    crop(fine.frame.width, cell, items_[i].at_left, cells);
                    if (std::abs(std::remainder(turn - angle, 2.0 * pi)) < 1e-9)
                        fine.layout[i].pose = fine.poses[i].size();
                    fine.poses[i].push_back(std::move(cells));
                }
                fine.layout[i].x = static_cast<Index>(strip.layout[i].x * tuning.finer);
                fine.layout[i].y = static_cast<Index>(strip.layout[i].y * tuning.finer);
            },
            drawing);
        const SeparationOptions moves{tuning.fine_reach, 2 * tuning.fine_turns + 1,
                                      tuning.fine_patience};
        separate(strip, moves, fine);
        fine.frame.height = used_height(fine.poses, fine.layout);
        auto budget = static_cast<std::int64_t>(options_.effort * tuning.fine_work);
        shrink(fine, moves, tuning.fine_attempt_work, budget, 2);
        strip = std::move(fine);
    }

    // Conservative images overlap where faithful ones do not: the layout is drawn out as little as
    // it takes to separate them, or made anew.
    void separate(const Strip& coarse, const SeparationOptions& moves, Strip& fine) const {
        Separation separation(fine.poses, 1, progress_, at_left_);
        double drawn = tuning.finer;
        for (int attempt = 0; attempt < tuning.attempts; ++attempt, drawn *= tuning.grown) {
            fine.frame.height = static_cast<Index>(std::ceil(drawn * coarse.frame.height)) + 2;
            for (std::size_t i = 0; i < items_.size(); ++i)
                fine.layout[i].y = static_cast<Index>(coarse.layout[i].y * drawn);
            auto work = static_cast<std::int64_t>(tuning.separating_work);
            if (separation.run(fine.layout, fine.frame, moves, work))
                return;
        }
        fine.frame.height = total_height(fine.poses);
        fine.layout = separation.fit_all(by_size(fine.poses), fine.frame);
    }

    StripResult finish(std::vector<Placement> placements) const {
        StripWalls walls;
        walls.width = options_.width;
        walls.gap = options_.gap;
        walls.at_left = at_left_;
        std::vector<Outline> outlines;
        for (std::size_t i = 0; i < items_.size(); ++i) {
            outlines.push_back(items_[i].outline);
            walls.may_turn.push_back(items_[i].angles.empty() ? 1 : 0);
            const Eigen::AlignedBox2d box = plane::box_of(items_[i].outline.hull, placements[i]);
            // Images are wider than their items, by less than two cells.
            const double least = items_[i].at_left ? box.min().x() : std::min(0.0, box.min().x());
            placements[i].offset.x() -= least;
            placements[i].offset.x() -= std::max(0.0, box.max().x() - least - options_.width);
        }
        placements = compact_strip(outlines, placements, walls, progress_);
        StripResult result;
        Eigen::AlignedBox2d box;
        for (std::size_t i = 0; i < outlines.size(); ++i)
            box.extend(plane::box_of(outlines[i].hull, placements[i]));
        for (Placement& placement : placements)
            placement.offset.y() -= box.min().y();
        result.placements = std::move(placements);
        result.length = box.sizes().y();
        return result;
    }

    const std::vector<StripItem>& items_;
    const StripOptions& options_;
    Progress& progress_;
    std::vector<std::uint8_t> at_left_;
    double coarse_cell_ = 1.0;
};

} // namespace

double least_width(const StripItem& item) {
    double least = infinite;
    for (const double angle : angles_of(item, tuning.turns))
        least = std::min(least, width_at(item.outline, angle));
    return least;
}

StripResult pack_strip(const std::vector<StripItem>& items, const StripOptions& options,
                       Progress& progress) {
    if (items.empty())
        return {};
    return StripSearch(items, options, progress).run();
}

} // namespace devseg::pack
