#include "devseg/pack/pack.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "devseg/base/errors.h"
#include "devseg/base/parallel.h"
#include "devseg/pack/compaction.h"
#include "devseg/pack/first_fit.h"
#include "devseg/pack/nest.h"
#include "devseg/plane/plane.h"

namespace devseg::pack {

namespace {

constexpr double expected_use = 0.75;      // of the square, by charts with half of the padding
constexpr double least_use = 0.1;          // what padding alone must leave of it
constexpr std::size_t most_nested = 1000;  // charts; nesting compares each with each
constexpr double enough_use = 0.75;        // of the box
constexpr double enough_use_of_many = 0.6; // where nesting would take seconds
// Independent searches, and how many of them are not given up halfway. An even number keeps two
// threads busy; it is the same whatever the threads.
constexpr std::size_t chains = 4;
constexpr std::size_t finished_chains = 2;
constexpr std::size_t finished_few = 8; // of the rectangles for a few charts, the smallest

// Heights of the rectangle, in widths, that are tried for a few charts.
constexpr double few_aspects[] = {1.0,  0.92, 0.85, 0.78, 0.71, 0.65, 0.59,
                                  0.53, 0.47, 0.41, 0.35, 0.3,  0.25};

Eigen::AlignedBox2d box_of(const std::vector<Outline>& outlines,
                           const std::vector<Placement>& placements) {
    Eigen::AlignedBox2d box;
    for (std::size_t i = 0; i < outlines.size(); ++i)
        box.extend(plane::box_of(outlines[i].hull, placements[i]));
    return box;
}

// The side of a square that charts, each grown by half of the padding, use as expected. They grow
// by an area of perimeter · m + π m², m = side · padding / 2: solved for the side.
double guess_side(const std::vector<Outline>& outlines, const PackOptions& options) {
    double area = 0.0;
    double perimeter = 0.0;
    double longest = 0.0;
    for (const Outline& outline : outlines) {
        area += outline.area;
        perimeter += plane::perimeter(outline.hull);
        const Vec2 size = plane::box_of(outline.hull).sizes();
        const double diagonal = size.norm() * std::sqrt(0.5);
        longest = std::max(longest, options.allow_rotation ? std::min(diagonal, size.maxCoeff())
                                                           : size.maxCoeff());
    }
    const double p = options.padding;
    const double a = expected_use - 0.25 * pi * p * p * static_cast<double>(outlines.size());
    if (a < least_use)
        throw InvalidParameter("padding: expected a share of the square's side that leaves room "
                               "for " +
                               std::to_string(outlines.size()) + " charts, found " +
                               std::to_string(p));
    const double b = 0.25 * p * perimeter;
    const double side = (b + std::sqrt(b * b + a * area)) / a;
    // Charts that are all points have no size; any will do.
    return std::max(side, longest) > 0.0 ? std::max(side, longest) : 1.0;
}

// What charts take up with half of the padding around them, where the square has this side.
double taken_area(const std::vector<Outline>& outlines, double padding, double side) {
    const double margin = 0.5 * padding * side;
    double area = 0.0;
    for (const Outline& outline : outlines)
        area += outline.area + margin * (plane::perimeter(outline.hull) + pi * margin);
    return area;
}

std::vector<Placement> find_placements(const NestProblem& problem, Progress& progress) {
    const bool few = problem.outlines.size() <= few_charts;
    const bool many = problem.outlines.size() > many_charts; // whose work is enough for two chains
    std::vector<CoarseLayout> begun(few ? std::size(few_aspects) : many ? finished_chains : chains);
    auto beginning = progress.part(0.4);
    parallel_for(
        static_cast<int>(begun.size()),
        [&](int k) {
            begun[k] = begin_nesting(problem, few ? few_aspects[k] : 1.0,
                                     static_cast<std::uint64_t>(k) + 1, beginning);
        },
        beginning);
    if (!few || !problem.is_thorough) {
        const auto bad = [](const CoarseLayout& c) {
            return badness(Vec2(c.frame.width, c.frame.height));
        };
        std::stable_sort(begun.begin(), begun.end(),
                         [&](const auto& a, const auto& b) { return bad(a) < bad(b); });
        begun.resize(few ? finished_few : finished_chains);
    }
    std::vector<std::vector<Placement>> found(begun.size());
    auto finishing = progress.part(0.6);
    parallel_for(
        static_cast<int>(found.size()),
        [&](int k) { found[k] = finish_nesting(problem, begun[k], finishing); }, finishing);
    const auto bad = [&](const std::vector<Placement>& placements) {
        return badness(box_of(problem.outlines, placements).sizes());
    };
    return *std::min_element(found.begin(), found.end(),
                             [&](const auto& a, const auto& b) { return bad(a) < bad(b); });
}

std::vector<Placement> nest(NestProblem& problem, Progress& progress) {
    auto preparing = progress.part(0.1);
    prepare(problem, preparing);
    auto placing = progress.part(0.9);
    return find_placements(problem, placing);
}

// The better one of two ways, of which the second is slow.
std::vector<Placement> fit_or_nest(NestProblem& problem, const PackOptions& options,
                                   Progress& progress) {
    const std::vector<Outline>& outlines = problem.outlines;
    auto fitting = progress.part(0.2);
    std::vector<Placement> fitted = pack_first_fit(outlines, options, problem.side, fitting);
    auto compacting = progress.part(0.1);
    parallel_for(
        1, [&](int) { fitted = compact(outlines, fitted, options, compacting); }, compacting);
    const Vec2 fitted_box = box_of(outlines, fitted).sizes();
    // Room that the padding takes is no reason to look for a better layout for seconds.
    const bool many = outlines.size() > very_many_charts;
    const double area = taken_area(outlines, many ? options.padding : 0.0, fitted_box.maxCoeff());
    if (outlines.size() > most_nested ||
        area >= (many ? enough_use_of_many : enough_use) * fitted_box.prod())
        return fitted;
    auto nesting = progress.part(0.7);
    std::vector<Placement> nested = nest(problem, nesting);
    return badness(box_of(outlines, nested).sizes()) < badness(fitted_box) ? nested : fitted;
}

// In its least box, the longer side below.
Placement lay_down(const Outline& outline, bool allow_rotation) {
    Placement placement;
    const double least = allow_rotation ? best_box_angle(outline) : 0.0;
    for (const double angle : {least, least + 0.5 * pi}) {
        placement = {std::cos(angle), std::sin(angle), Vec2::Zero()};
        const Eigen::AlignedBox2d box = plane::box_of(outline.hull, placement);
        placement.offset = -box.min();
        if (!allow_rotation || box.sizes().x() >= box.sizes().y())
            break;
    }
    return placement;
}

} // namespace

PackResult pack_charts(const std::vector<PackItem>& items, const PackOptions& options,
                       Progress& progress) {
    if (!(options.padding >= 0.0) || !(options.padding <= 0.1))
        throw InvalidParameter("padding: expected a share of the square's side from 0 to 0.1, "
                               "found " +
                               std::to_string(options.padding));
    PackResult result;
    if (items.empty())
        return result;
    NestProblem problem;
    problem.padding = options.padding;
    problem.allow_rotation = options.allow_rotation;
    problem.is_thorough = options.effort == PackEffort::best;
    problem.outlines.resize(items.size());
    auto outlining = progress.part(0.05);
    parallel_for(
        static_cast<int>(items.size()),
        [&](int i) { problem.outlines[i] = find_outline(*items[i].faces, *items[i].points); },
        outlining);
    auto placing = progress.part(0.95);
    problem.side = guess_side(problem.outlines, options);
    if (items.size() == 1)
        result.placements = {lay_down(problem.outlines.front(), options.allow_rotation)};
    else if (options.effort == PackEffort::fast)
        result.placements = pack_first_fit(problem.outlines, options, problem.side, placing);
    else if (items.size() > many_charts)
        result.placements = fit_or_nest(problem, options, placing);
    else
        result.placements = nest(problem, placing);
    const Eigen::AlignedBox2d box = box_of(problem.outlines, result.placements);
    // The border of the square keeps half of the padding as well.
    result.side = box.sizes().maxCoeff() / (1.0 - options.padding);
    const Vec2 shift = Vec2::Constant(0.5 * options.padding * result.side) - box.min();
    for (Placement& placement : result.placements)
        placement.offset += shift;
    return result;
}

PackResult pack_rows(const std::vector<PackItem>& items, double padding) {
    std::vector<Eigen::AlignedBox2d> boxes;
    double area = 0.0;
    double longest = 0.0;
    for (const PackItem& item : items) {
        boxes.push_back(plane::box_of(*item.points));
        longest = std::max(longest, boxes.back().sizes().maxCoeff());
    }
    const double gap = padding * longest;
    for (const Eigen::AlignedBox2d& box : boxes)
        area += (box.sizes() + Vec2::Constant(gap)).prod();
    std::vector<std::size_t> order(items.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return boxes[a].sizes().y() > boxes[b].sizes().y();
    });
    PackResult result;
    result.placements.resize(items.size());
    const double width = std::max(std::sqrt(area), longest);
    Vec2 place = Vec2::Constant(gap);
    double next_row = gap;
    for (const std::size_t i : order) {
        const Vec2 size = boxes[i].sizes();
        if (place.x() > gap && place.x() + size.x() > width)
            place = Vec2(gap, next_row);
        result.placements[i].offset = place - boxes[i].min();
        next_row = std::max(next_row, place.y() + size.y() + gap);
        place.x() += size.x() + gap;
        result.side = std::max({result.side, place.x(), next_row});
    }
    return result;
}

} // namespace devseg::pack
