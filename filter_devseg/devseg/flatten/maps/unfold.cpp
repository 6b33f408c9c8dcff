#include "devseg/flatten/maps/unfold.h"

#include <cmath>
#include <queue>
#include <utility>

#include <Eigen/Geometry>

#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

// The edge from corner k to corner k + 1 of a rest triangle.
Vec2 rest_edge(const FlatteningProblem& problem, HalfEdge h) {
    const Eigen::Matrix2d& edges = problem.edges[h / 3];
    if (h % 3 == 0)
        return edges.col(0);
    return h % 3 == 1 ? Vec2(edges.col(1) - edges.col(0)) : Vec2(-edges.col(1));
}

double direction(const Vec2& v) {
    return std::atan2(v.y(), v.x());
}

// Lengths of all edges, which is more than two triangles agree on: the sheet closes.
bool keeps_lengths(const FlatteningProblem& problem, const std::vector<Vec2>& uv, double bound) {
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Triangle& t = problem.faces[f];
        const Vec2 a = problem.edges[f].col(0);
        const Vec2 b = problem.edges[f].col(1);
        const double expected[] = {a.norm(), (b - a).norm(), b.norm()};
        for (std::size_t k = 0; k < 3; ++k) {
            const double found = (uv[t[(k + 1) % 3]] - uv[t[k]]).norm();
            if (!(std::abs(found - expected[k]) <= bound))
                return false;
        }
    }
    return true;
}

} // namespace

std::optional<std::vector<Vec2>> unfold(const FlatteningProblem& problem,
                                        const std::vector<HalfEdge>& twin, double tolerance) {
    std::vector<Vec2> uv(at(problem.vertex_count), Vec2::Zero());
    std::vector<std::uint8_t> placed(uv.size(), 0);
    std::vector<std::uint8_t> seen(problem.faces.size(), 0);
    // Each face is turned as a whole, by the sum of the angles on the way to it. Placing corners
    // beside two that lie there would multiply their errors from face to face.
    std::vector<double> turn(problem.faces.size(), 0.0);
    // Across the longest edge first: its direction is known best.
    std::priority_queue<std::pair<double, Index>> edges;
    const auto place = [&](Face f, Index anchor) {
        const Eigen::Rotation2Dd rotation(turn[f]);
        for (HalfEdge h = anchor, i = 0; i < 2; ++i, h = Mesh::next(h)) {
            const Triangle& t = problem.faces[f];
            const Index from = t[h % 3];
            const Index to = t[Mesh::next(h) % 3];
            if (placed[to] == 0)
                uv[to] = uv[from] + rotation * rest_edge(problem, h);
            placed[to] = 1;
        }
        seen[f] = 1;
        for (const HalfEdge h : half_edges_of(f))
            if (twin[h] >= 0 && seen[twin[h] / 3] == 0)
                edges.emplace(rest_edge(problem, h).squaredNorm(), -h);
    };
    placed[problem.faces.front()[0]] = 1;
    place(0, 0);
    while (!edges.empty()) {
        const HalfEdge h = -edges.top().second;
        edges.pop();
        const Index other = twin[h];
        if (seen[other / 3] != 0)
            continue;
        turn[other / 3] =
            turn[h / 3] + direction(-rest_edge(problem, h)) - direction(rest_edge(problem, other));
        place(other / 3, other);
    }
    if (!keeps_lengths(problem, uv, tolerance * std::sqrt(problem.total_area)) ||
        count_flips(problem, uv) > 0)
        return std::nullopt;
    return uv;
}

} // namespace devseg::flatten
