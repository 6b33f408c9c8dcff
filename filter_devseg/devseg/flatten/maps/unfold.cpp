#include "devseg/flatten/maps/unfold.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include <Eigen/Geometry>

#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

Vec2 rest_edge(const FlatteningProblem& problem, HalfEdge h) {
    const Face f = face_of(h);
    return problem.corner(f, corner_of(Mesh::next(h))) - problem.corner(f, corner_of(h));
}

double direction(const Vec2& v) {
    return std::atan2(v.y(), v.x());
}

// Lengths of all edges of a face, which is more than two triangles agree on: the sheet closes.
bool keeps_lengths(const FlatteningProblem& problem, const std::vector<Vec2>& uv, Face f,
                   double bound) {
    for (const HalfEdge h : half_edges_of(f)) {
        const Triangle& t = problem.faces[f];
        const double found = (uv[t[corner_of(Mesh::next(h))]] - uv[t[corner_of(h)]]).norm();
        if (!(std::abs(found - rest_edge(problem, h).norm()) <= bound))
            return false;
    }
    return true;
}

} // namespace

std::optional<std::vector<Vec2>> unfold(const FlatteningProblem& problem, double tolerance) {
    const std::vector<HalfEdge>& twin = problem.twin;
    std::vector<Vec2> uv(at(problem.vertex_count), Vec2::Zero());
    std::vector<std::uint8_t> placed(uv.size(), 0);
    std::vector<std::uint8_t> seen(problem.faces.size(), 0);
    // Each face is turned as a whole, by the sum of the angles on the way to it. Placing corners
    // beside two that lie there would multiply their errors from face to face.
    std::vector<double> turn(problem.faces.size(), 0.0);
    // Across the longest edge first: its direction is known best.
    std::priority_queue<std::pair<double, Index>> edges;
    // Corners stay where they are once they lie: most charts show early that they do not unfold.
    const double bound = tolerance * std::sqrt(problem.total_area);
    std::size_t laid = 0;
    bool keeps = true;
    const auto place = [&](HalfEdge anchor) {
        const Face f = face_of(anchor);
        const Eigen::Rotation2Dd rotation(turn[f]);
        for (const HalfEdge h : {anchor, Mesh::next(anchor)}) {
            const Vertex from = problem.faces[f][corner_of(h)];
            const Vertex to = problem.faces[f][corner_of(Mesh::next(h))];
            if (placed[to] == 0)
                uv[to] = uv[from] + rotation * rest_edge(problem, h);
            placed[to] = 1;
        }
        seen[f] = 1;
        ++laid;
        keeps = keeps_lengths(problem, uv, f, bound);
        for (const HalfEdge h : half_edges_of(f))
            if (twin[h] >= 0 && seen[face_of(twin[h])] == 0)
                edges.emplace(rest_edge(problem, h).squaredNorm(), -h);
    };
    placed[problem.faces.front()[0]] = 1;
    place(0);
    while (keeps && !edges.empty()) {
        const HalfEdge h = -edges.top().second;
        edges.pop();
        const HalfEdge other = twin[h];
        if (seen[face_of(other)] != 0)
            continue;
        turn[face_of(other)] = turn[face_of(h)] + direction(-rest_edge(problem, h)) -
                               direction(rest_edge(problem, other));
        place(other);
    }
    if (!keeps || laid < problem.faces.size() || count_flips(problem, uv) > 0)
        return std::nullopt;
    return uv;
}

double largest_defect(const FlatteningProblem& problem) {
    std::vector<double> sum(at(problem.vertex_count), 0.0);
    std::vector<std::uint8_t> is_inner(sum.size(), 1);
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        for (const HalfEdge h : half_edges_of(static_cast<Index>(f))) {
            const Triangle& t = problem.faces[f];
            const Vertex v = t[corner_of(h)];
            sum[v] +=
                plane::angle_between(rest_edge(problem, h), -rest_edge(problem, Mesh::previous(h)));
            if (problem.twin[h] < 0)
                is_inner[v] = is_inner[t[corner_of(Mesh::next(h))]] = 0;
        }
    double largest = 0.0;
    for (std::size_t v = 0; v < sum.size(); ++v)
        if (is_inner[v] != 0)
            largest = std::max(largest, std::abs(sum[v] - 2.0 * pi));
    return largest;
}

} // namespace devseg::flatten
