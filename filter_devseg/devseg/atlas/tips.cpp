#include "devseg/atlas/tips.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "devseg/atlas/join_loops.h"
#include "devseg/graph/unions.h"

namespace devseg::atlas {

namespace {

constexpr double horn_height = 0.5; // least height, share of the loop

// Faces joined from the farthest to the nearest, and what is known about each joined part.
class Parts {
public:
    Parts(const ChartSurface& surface, const std::vector<double>& distance)
        : s_(surface), distance_(distance), sets_(surface.faces.size()),
          perimeter_(surface.faces.size(), 0.0), tip_(surface.faces.size(), -1),
          found_(surface.faces.size(), 0) {}

    /// Adds a face; lengths are of its edges. Returns the part it belongs to now.
    Index add(Face f, const std::array<double, 3>& lengths) {
        perimeter_[f] = lengths[0] + lengths[1] + lengths[2];
        for (const Vertex v : s_.faces[f])
            if (tip_[f] < 0 || farther(v, tip_[f]))
                tip_[f] = v;
        Index part = f;
        for (const HalfEdge h : half_edges_of(f)) {
            const Face g = s_.across(h);
            if (g < 0 || tip_[g] < 0)
                continue;
            part = join(part, sets_.find(g));
            perimeter_[part] -= 2.0 * lengths[corner_of(h)];
        }
        return part;
    }
    double perimeter(Index part) const { return perimeter_[part]; }
    Index tip(Index part) const { return tip_[part]; }
    /// Whether the part's tip has been taken; takes it.
    bool take(Index part) { return std::exchange(found_[part], std::uint8_t{1}) == 0; }

private:
    bool farther(Index a, Index b) const {
        return distance_[a] != distance_[b] ? distance_[a] > distance_[b] : a < b;
    }
    Index join(Index a, Index b) {
        if (a == b)
            return a;
        if (farther(tip_[b], tip_[a]))
            std::swap(a, b);
        sets_.join(a, b);
        perimeter_[a] += perimeter_[b];
        // The far end of both was far enough for a loop that only one of them has: it stays taken.
        if (tip_[a] == tip_[b])
            found_[a] |= found_[b];
        return a;
    }

    const ChartSurface& s_;
    const std::vector<double>& distance_;
    graph::Unions sets_; // of faces
    std::vector<double> perimeter_;
    std::vector<Index> tip_; // the farthest vertex, −1 before a face is added
    std::vector<std::uint8_t> found_;
};

} // namespace

std::vector<Index> find_tips(const Mesh& mesh, const ChartSurface& surface,
                             const std::vector<double>& distance, const TipRule& rule,
                             const Progress& progress) {
    Heartbeat beat(progress);
    std::vector<double> level;
    for (const auto& [a, b, c] : surface.faces)
        level.push_back(std::min({distance[a], distance[b], distance[c]}));
    std::vector<Index> order(surface.faces.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(),
              [&](Index a, Index b) { return level[a] != level[b] ? level[a] > level[b] : a < b; });
    double boundary = 0.0;
    for (const std::vector<Index>& loop : surface.loops)
        boundary += loop_length(mesh, surface, loop);
    Parts parts(surface, distance);
    std::vector<Index> tips;
    for (const Face f : order) {
        beat();
        std::array<double, 3> lengths{};
        for (const HalfEdge h : half_edges_of(f))
            lengths[corner_of(h)] = mesh.edge_length(surface.mesh_half_edge(h));
        const Index part = parts.add(f, lengths);
        const Index tip = parts.tip(part);
        const double loop = parts.perimeter(part);
        const double height = distance[tip] - level[f];
        const bool is_horn = loop <= rule.horn_loop * boundary && height >= horn_height * loop;
        // At the level of the boundary the part is the chart, and its tip the farthest vertex.
        const bool is_end = level[f] <= 0.0 && distance[tip] >= boundary;
        if (height > 0.0 && (is_horn || is_end) && parts.take(part))
            tips.push_back(tip);
    }
    std::sort(tips.begin(), tips.end());
    tips.erase(std::unique(tips.begin(), tips.end()), tips.end());
    return tips;
}

} // namespace devseg::atlas
