#include "devseg/pack/nest.h"

#include <algorithm>
#include <cmath>

#include "devseg/base/parallel.h"
#include "devseg/pack/compaction.h"

// Sanitizers make the search thirty times as slow: their builds ask for a part of it.
#ifndef DEVSEG_NESTING_SHARE
#define DEVSEG_NESTING_SHARE 1.0
#endif

namespace devseg::pack {

namespace {

// The coarse grid. Values are the best of those measured on the charts of 22 public meshes.
constexpr double coarse_cells = 96.0; // along the square's side
constexpr double most_coarse_cells = 512.0;
constexpr double usual_charts = 20.0; // more charts are given more cells, by the square root
constexpr Index supersampling = 4;    // cells that decide on one coarse cell, to a side
constexpr int orientations = 32;
constexpr double start_growth = 1.15;  // the first square, in sides of the guess
constexpr double coarse_growth = 1.05; // while the first square is too small
constexpr double coarse_step = 0.04;   // first attempt at shrinking, as a share of the side
constexpr double first_work = 3.0e8;   // operations to separate charts in the first square
constexpr double begin_work = 0.6e9;   // and in smaller and smaller squares,
constexpr double next_step = 0.01;  // then again in steps from this one on, and on the fine grid,
constexpr double next_work = 0.8e9; // for the layouts that are worth it
constexpr double most_work_factor = 2.0;  // for many charts, by their number, which is this
constexpr double many_crowd = 10.0;       // multiple of the usual one where the factor is 1;
constexpr double least_many_factor = 0.5; // twice as much would cover 1 % more, in half a second
// Less for few charts, for which fewer places come into question: by the square of their number.
constexpr double least_work_factor = 0.12;
constexpr double few_work_factor = 0.1; // few charts are tried in many frames
constexpr int no_failure_limit = 1000;  // beyond what the work allows

// What is enough of the work. On the charts of 25 public meshes the rest covers 0.5 % more.
struct Share {
    double begin = 1.0;
    double next = 1.0;
    double fine = 1.0;
};
constexpr Share usual_share{0.5, 0.75, 0.5};
constexpr Share few_share{0.25, 0.1, 0.1}; // few charts lie well early, in one of many frames

constexpr SeparationOptions many_moves{12, 4};

// The fine grid.
constexpr double fine_cells = 768.0;
constexpr double most_fine_cells = 3072.0;
constexpr double fine_turn = 1.5 * pi / 180.0;
constexpr int fine_turns = 2; // to each side
constexpr double fine_growth = 1.005;
constexpr double fine_first_work = 5.0e7;
constexpr double fine_work = 3.0e8;
constexpr int fine_failures = 6;
constexpr SeparationOptions fine_moves{7, 2 * fine_turns + 1, 40};

// The distance to keep is a share of a side that is only known afterwards. The fine search assumes
// one that is larger than the coarse square by this factor, and starts again if it was too small.
constexpr double padding_reserve = 1.05;
constexpr double padding_step = 1.1;

double crowd_of(std::size_t charts) {
    return std::max(1.0, static_cast<double>(charts) / usual_charts);
}

double work_factor(std::size_t charts) {
    if (charts <= few_charts)
        return DEVSEG_NESTING_SHARE * few_work_factor;
    const double n = static_cast<double>(charts);
    return DEVSEG_NESTING_SHARE *
           (charts <= many_charts
                ? std::clamp(std::pow((n - 5.0) / 15.0, 2), least_work_factor, 1.0)
                : std::clamp(crowd_of(charts) / many_crowd, least_many_factor, most_work_factor));
}

Share share_of(const NestProblem& problem) {
    const std::size_t charts = problem.outlines.size();
    if (problem.is_thorough || charts > many_charts) // whose work is short as it is
        return {};
    return charts <= few_charts ? few_share : usual_share;
}

SeparationOptions coarse_moves(std::size_t charts) {
    return charts > many_charts ? many_moves : SeparationOptions{};
}

Frame frame_of(double width, double aspect) {
    return {static_cast<Index>(width), std::max(Index{1}, static_cast<Index>(width * aspect))};
}

// A frame that shrinks as long as the charts can be separated.
class Shrinking {
public:
    Shrinking(const std::vector<ChartPoses>& poses, double aspect, const SeparationOptions& options,
              std::uint64_t seed, const Progress& progress)
        : poses_(poses), aspect_(aspect), options_(options), separation_(poses, seed, progress) {}

    Layout layout;
    Frame frame;

    // Finds a first feasible frame, from `width` cells upwards. An empty layout is made anew.
    void grow(double width, double factor, double work) {
        for (int attempt = 0;; ++attempt, width *= factor) {
            frame = frame_of(width, aspect_);
            // A first fit is the last resort: it succeeds as soon as the frame is large enough.
            const bool fit = poses_.size() > very_many_charts && layout.empty();
            if (fit || attempt >= patient_attempts) {
                layout = separation_.fit_all(by_size(poses_), frame);
                factor = coarse_growth;
            } else if (layout.empty()) {
                layout = separation_.insert_all(by_size(poses_), frame, options_);
            }
            if (layout.empty())
                continue;
            auto budget = static_cast<std::int64_t>(work);
            if (separation_.run(layout, frame, options_, budget))
                return;
        }
    }

    void shrink(double step, double work, int failures) {
        auto budget = static_cast<std::int64_t>(work);
        bool other_side = false;
        while (budget > 0 && failures > 0) {
            const Frame next = smaller(step, other_side);
            if (separation_.run(layout, next, options_, budget)) {
                frame = next;
            } else {
                other_side = !other_side;
                step *= 0.5;
                --failures;
            }
        }
    }

private:
    static constexpr int patient_attempts = 8;
    static constexpr double most_drift = 0.02; // away from the aspect

    // A cell of a coarse grid is a large step already: it is taken from one side only, from the one
    // that is too long for the aspect or, unless it is far too short, from the other one.
    Frame smaller(double step, bool other_side) const {
        const auto cells = static_cast<Index>(std::max(frame.width, frame.height) * step);
        if (cells > 1) {
            const Frame next = frame_of(frame.width - cells, aspect_);
            return {next.width, std::min(next.height, frame.height)};
        }
        const double excess = frame.width * aspect_ / frame.height; // of the width
        const bool other = other_side && std::abs(excess - 1.0) < most_drift;
        return (excess >= 1.0) != other ? Frame{frame.width - 1, frame.height}
                                        : Frame{frame.width, frame.height - 1};
    }

    const std::vector<ChartPoses>& poses_;
    double aspect_;
    SeparationOptions options_;
    Separation separation_;
};

// The same layout on a finer grid, where charts may turn a little.
std::vector<ChartPoses> refine(const NestProblem& problem, Layout& layout, double cell,
                               double margin) {
    std::vector<ChartPoses> poses(layout.size());
    const int turns = problem.allow_rotation ? fine_turns : 0;
    for (std::size_t i = 0; i < layout.size(); ++i) {
        const ChartCells& coarse = problem.poses[i][layout[i].pose];
        for (int k = -turns; k <= turns; ++k)
            poses[i].push_back(rasterize(problem.outlines[i],
                                         std::atan2(coarse.sine, coarse.cosine) + k * fine_turn,
                                         cell, margin));
        layout[i].pose = static_cast<std::size_t>(turns);
        layout[i].x = static_cast<Index>(layout[i].x * problem.cell / cell);
        layout[i].y = static_cast<Index>(layout[i].y * problem.cell / cell);
    }
    return poses;
}

} // namespace

void prepare(NestProblem& problem, Progress& progress) {
    const std::size_t n = problem.outlines.size();
    const double crowd = crowd_of(n);
    problem.cell = problem.side / std::min(most_coarse_cells, coarse_cells * std::sqrt(crowd));
    const int turns = !problem.allow_rotation ? 1
                      : n <= very_many_charts ? orientations
                                              : few_orientations;
    problem.poses.resize(problem.outlines.size());
    const double margin = 0.5 * problem.padding * problem.side;
    parallel_for(
        static_cast<int>(n),
        [&](int i) {
            const Outline& outline = problem.outlines[i];
            const double base = problem.allow_rotation ? best_box_angle(outline) : 0.0;
            for (int k = 0; k < turns; ++k)
                problem.poses[i].push_back(coarsen(rasterize(outline, base + 2.0 * pi * k / turns,
                                                             problem.cell / supersampling, margin),
                                                   supersampling));
        },
        progress);
}

CoarseLayout begin_nesting(const NestProblem& problem, double aspect, std::uint64_t seed,
                           const Progress& progress) {
    const std::size_t n = problem.outlines.size();
    Shrinking coarse(problem.poses, aspect, coarse_moves(n), seed, progress);
    coarse.grow(start_growth * problem.side / problem.cell / std::sqrt(aspect), coarse_growth,
                first_work);
    coarse.shrink(coarse_step, share_of(problem).begin * begin_work * work_factor(n),
                  no_failure_limit);
    return {std::move(coarse.layout), coarse.frame, aspect, seed};
}

std::vector<Placement> finish_nesting(const NestProblem& problem, const CoarseLayout& begun,
                                      const Progress& progress) {
    const std::size_t n = problem.outlines.size();
    const double crowd = crowd_of(n);
    // The seed is another one: with the same one, the same orders of moves would fail again.
    Shrinking coarse(problem.poses, begun.aspect, coarse_moves(n), ~begun.seed, progress);
    coarse.layout = begun.layout;
    coarse.frame = begun.frame;
    coarse.shrink(next_step, share_of(problem).next * next_work * work_factor(n), no_failure_limit);

    const Frame frame = coarse.frame;
    const double cells = std::min(most_fine_cells, fine_cells * std::sqrt(crowd));
    const double cell = frame.width * problem.cell / cells;
    const double fine_aspect = static_cast<double>(frame.height) / frame.width;
    const double longer = std::max(1.0, fine_aspect); // side of the frame, in widths
    for (double assumed = padding_reserve * cell * cells * longer;; assumed *= padding_step) {
        Layout layout = coarse.layout;
        const std::vector<ChartPoses> poses =
            refine(problem, layout, cell, 0.5 * problem.padding * assumed);
        Shrinking fine(poses, fine_aspect, fine_moves, begun.seed, progress);
        fine.layout = std::move(layout);
        fine.grow(cells, fine_growth, fine_first_work * crowd);
        if (cell * std::max(fine.frame.width, fine.frame.height) > assumed)
            continue;
        fine.shrink(next_step, share_of(problem).fine * fine_work * work_factor(n), fine_failures);
        std::vector<Placement> placements(n);
        for (std::size_t i = 0; i < n; ++i)
            placements[i] = placement_of(poses[i][fine.layout[i].pose], fine.layout[i], cell);
        return compact(problem.outlines, placements, {problem.padding, problem.allow_rotation},
                       progress);
    }
}

} // namespace devseg::pack
