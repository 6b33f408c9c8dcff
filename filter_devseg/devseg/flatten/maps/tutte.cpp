// References
//   W. T. Tutte: How to Draw a Graph. Proceedings of the London Mathematical Society 13, 1963.
//   M. S. Floater: One-to-one Piecewise Linear Mappings over Triangulations. Mathematics of
//   Computation 72, 2003. doi:10.1090/S0025-5718-02-01466-7
#include "devseg/flatten/maps/tutte.h"

#include <algorithm>
#include <cmath>

#include "devseg/flatten/energy/harmonic.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/maps/lscm.h"

namespace devseg::flatten {

namespace {

// Cotangents below this, or above its inverse, come from angles above 87 or below 3 degrees: as
// they are, they could be negative, and so break the guarantee, or drown all other weights.
constexpr double least_cotangent = 0.05;

std::vector<Vec2> place_boundary(const FlatteningProblem& problem) {
    std::vector<Vec2> uv(at(problem.vertex_count), Vec2::Zero());
    double length = 0.0;
    double longest = 0.0;
    for (const double l : problem.boundary_edge) {
        length += l;
        longest = std::max(longest, l);
    }
    // Every edge gets some arc, so that the polygon is strictly convex whatever the lengths.
    const double least = 1e-3 * longest;
    double total = 0.0;
    for (const double l : problem.boundary_edge)
        total += std::max(l, least);
    const double radius = std::sqrt(problem.total_area / pi);
    double walked = 0.0;
    for (std::size_t i = 0; i < problem.boundary.size(); ++i) {
        const double angle = 2.0 * pi * walked / total;
        uv[problem.boundary[i]] = radius * Vec2(std::cos(angle), std::sin(angle));
        walked += std::max(problem.boundary_edge[i], least);
    }
    return uv;
}

} // namespace

std::vector<Vec2> flatten_tutte(const FlatteningProblem& problem) {
    expect_no_holes(problem);
    const std::vector<Vec2> circle = place_boundary(problem);
    std::vector<Vec2> uv = circle;
    HarmonicMap(problem, uv, [](double cotangent) {
        return std::clamp(cotangent, least_cotangent, 1.0 / least_cotangent);
    });
    if (count_flips(problem, uv) > 0) {
        uv = circle;
        HarmonicMap(problem, uv, [](double) { return 1.0; });
    }
    scale_to_area(problem, uv);
    return uv;
}

std::vector<Vec2> simple_map(const FlatteningProblem& problem) {
    std::vector<Vec2> uv = flatten_lscm(problem);
    return count_flips(problem, uv) > 0 ? flatten_tutte(problem) : uv;
}

} // namespace devseg::flatten
