#include "devseg/flatten/repair/slits.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

struct Tuning {
    double kept_height = 0.1; // share of the lowest face's height by which a lip may move
    double needle = 0.1;      // of the gap: lower faces have no shape to keep
};
constexpr Tuning tuning;

// Local number of the other side of each boundary half-edge that lies on a cut inside the chart,
// as pairs of local half-edges.
std::vector<std::pair<Index, Index>> slit_sides(const Mesh& mesh,
                                                const atlas::ChartSurface& surface) {
    std::vector<std::pair<Index, Index>> by_mesh; // (mesh half-edge, local half-edge)
    for (const std::vector<Index>& loop : surface.loops)
        for (const HalfEdge h : loop)
            by_mesh.emplace_back(surface.mesh_half_edge(h), h);
    std::sort(by_mesh.begin(), by_mesh.end());
    std::vector<std::pair<Index, Index>> sides;
    for (const auto& [global, h] : by_mesh) {
        const HalfEdge twin = mesh.twin[global];
        const auto other =
            std::lower_bound(by_mesh.begin(), by_mesh.end(), std::pair<Index, Index>(twin, 0));
        if (twin > global && other != by_mesh.end() && other->first == twin)
            sides.emplace_back(h, other->second);
    }
    return sides;
}

class SlitOpener {
public:
    SlitOpener(const atlas::ChartSurface& surface, double gap, std::vector<Vec2>& uv)
        : s_(surface), gap_(gap), uv_(uv), home_(uv), done_(surface.vertex.size(), 0) {}

    // Vertices v and w are the same point of the surface on the sides h and g of a slit.
    void part(Vertex v, Vertex w, HalfEdge h, HalfEdge g) {
        if (v == w || (home_[v] - home_[w]).norm() >= gap_)
            return;
        move(v, h);
        move(w, g);
    }

private:
    void move(Vertex v, HalfEdge h) {
        if (done_[v] != 0)
            return;
        const Vec2 edge = home_[s_.target(h)] - home_[s_.origin(h)];
        const double length = edge.norm();
        if (!(length > 0.0))
            return;
        const HalfEdge leaving = s_.origin(h) == v ? h : Mesh::next(h);
        const double step = std::min(0.5 * gap_, tuning.kept_height * lowest_around(leaving));
        uv_[v] = home_[v] + step / length * plane::left_of(edge);
        done_[v] = 1;
        if (!is_positive_around(s_.faces, s_.twin, uv_, leaving))
            uv_[v] = home_[v];
    }

    // A small chart has faces as low as the gap of a large model is wide.
    double lowest_around(HalfEdge leaving) const {
        double lowest = infinite;
        mesh::visit_star(s_.twin, leaving, [&](HalfEdge h) {
            const Triangle& t = s_.faces[face_of(h)];
            const Vec2 a = home_[t[1]] - home_[t[0]];
            const Vec2 b = home_[t[2]] - home_[t[0]];
            const double height =
                std::abs(plane::cross(a, b)) / std::max({a.norm(), b.norm(), (b - a).norm()});
            if (height > tuning.needle * gap_)
                lowest = std::min(lowest, height);
        });
        return lowest;
    }

    const atlas::ChartSurface& s_;
    double gap_;
    std::vector<Vec2>& uv_;
    std::vector<Vec2> home_;
    std::vector<std::uint8_t> done_;
};

} // namespace

void open_closed_slits(const Mesh& mesh, const atlas::ChartSurface& surface, double gap,
                       std::vector<Vec2>& uv) {
    SlitOpener opener(surface, gap, uv);
    for (const auto& [h, g] : slit_sides(mesh, surface)) {
        opener.part(surface.origin(h), surface.target(g), h, g);
        opener.part(surface.target(h), surface.origin(g), h, g);
    }
}

bool closed_slits_hide_loops(const Mesh& mesh, const atlas::ChartSurface& surface, double gap,
                             const std::vector<Vec2>& uv) {
    std::vector<Index> same(surface.vertex.size());
    std::iota(same.begin(), same.end(), 0);
    const auto find = [&](Vertex v) {
        while (same[v] != v)
            v = same[v] = same[same[v]];
        return v;
    };
    const auto meet = [&](Vertex v, Index w) { return v == w || (uv[v] - uv[w]).norm() < gap; };
    // Every closed edge is one edge less; the vertices that it joins are fewer as well, by as many
    // as it takes for the chart to keep its loops, or not.
    Index euler = surface.euler_characteristic();
    for (const auto& [h, g] : slit_sides(mesh, surface)) {
        if (!meet(surface.origin(h), surface.target(g)) ||
            !meet(surface.target(h), surface.origin(g)))
            continue;
        ++euler;
        for (const auto& [v, w] : {std::pair(surface.origin(h), surface.target(g)),
                                   std::pair(surface.target(h), surface.origin(g))}) {
            const Index a = find(v);
            const Index b = find(w);
            euler -= a == b ? 0 : 1;
            same[a] = b;
        }
    }
    return euler != surface.euler_characteristic();
}

} // namespace devseg::flatten
