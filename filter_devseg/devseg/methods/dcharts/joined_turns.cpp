#include "devseg/methods/dcharts/joined_turns.h"

#include <algorithm>
#include <array>
#include <complex>

#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::dcharts {

namespace {

// A half-edge in the plane, its face turned so.
std::complex<double> laid(const Mesh& mesh, const Vec2& turn, HalfEdge h) {
    const Face f = face_of(h);
    std::array<double, 3> length{};
    for (const HalfEdge e : half_edges_of(f))
        length[corner_of(e)] = mesh.edge_length(e);
    const Eigen::Matrix2d edges = flatten::make_rest_triangle(length, 0.0).edges;
    const std::array<Vec2, 3> corner{Vec2(0.0, 0.0), edges.col(0), edges.col(1)};
    const Vec2 edge = corner[corner_of(Mesh::next(h))] - corner[corner_of(h)];
    return std::complex<double>(turn.x(), turn.y()) * std::complex<double>(edge.x(), edge.y());
}

// By how much the second chart turns: the direction of the sum over the edges of their direction
// on one side over that on the other.
std::complex<double> turn_between(const Mesh& mesh, const Draft& draft, const Closing& closing) {
    const auto [a, b] = closing.charts;
    const auto turn_of = [&](Index chart, Face f) {
        const std::vector<Index>& faces = draft.faces[chart];
        return draft.map[chart].turns[at(static_cast<Index>(
            std::lower_bound(faces.begin(), faces.end(), Index{f}) - faces.begin()))];
    };
    std::complex<double> between = 0.0;
    for (const HalfEdge edge : closing.edges) {
        const HalfEdge ha = draft.chart[face_of(edge)] == a ? edge : mesh.twin[edge];
        const HalfEdge hb = mesh.twin[ha];
        between += laid(mesh, turn_of(a, face_of(ha)), ha) *
                   std::conj(-laid(mesh, turn_of(b, face_of(hb)), hb));
    }
    const double size = std::abs(between);
    return size > 0.0 ? between / size : 1.0;
}

} // namespace

std::vector<Vec2> joined_turns(const Mesh& mesh, const Draft& draft, const Closing& closing) {
    const auto [a, b] = closing.charts;
    if (!closing.opened.empty())
        return {};
    const std::vector<Vec2>& turns_a = draft.map[a].turns;
    const std::vector<Vec2>& turns_b = draft.map[b].turns;
    if (a == b || turns_a.empty() || turns_b.empty())
        return a == b ? turns_a : std::vector<Vec2>();
    const std::complex<double> turn = turn_between(mesh, draft, closing);
    std::vector<Vec2> turns;
    auto ia = draft.faces[a].begin();
    auto ib = draft.faces[b].begin();
    auto ta = turns_a.begin();
    auto tb = turns_b.begin();
    while (ia != draft.faces[a].end() || ib != draft.faces[b].end()) {
        if (ib == draft.faces[b].end() || (ia != draft.faces[a].end() && *ia < *ib)) {
            turns.push_back(*ta++);
            ++ia;
        } else {
            const std::complex<double> turned = turn * std::complex<double>(tb->x(), tb->y());
            turns.emplace_back(turned.real(), turned.imag());
            ++tb;
            ++ib;
        }
    }
    return turns;
}

} // namespace devseg::dcharts
