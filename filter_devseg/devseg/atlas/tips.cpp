#include "devseg/atlas/tips.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "devseg/atlas/join_loops.h"

namespace devseg::atlas {

namespace {

constexpr double horn_height = 0.5; // least height, share of the loop

// Faces joined from the farthest to the nearest, and what is known about each joined part.
class Parts {
public:
    Parts(const ChartSurface& surface, const std::vector<double>& distance)
        : s_(surface), distance_(distance), parent_(surface.face.size(), -1),
          perimeter_(surface.face.size(), 0.0), tip_(surface.face.size(), -1),
          found_(surface.face.size(), 0) {}

    /// Adds a face; lengths are of its edges. Returns the part it belongs to now.
    Index add(Index f, const std::array<double, 3>& lengths) {
        parent_[at(f)] = f;
        perimeter_[at(f)] = lengths[0] + lengths[1] + lengths[2];
        tip_[at(f)] = s_.origin(3 * f);
        for (Index k = 1; k < 3; ++k)
            if (farther(s_.origin(3 * f + k), tip_[at(f)]))
                tip_[at(f)] = s_.origin(3 * f + k);
        Index part = f;
        for (Index k = 0; k < 3; ++k) {
            const Index twin = s_.twin[at(3 * f + k)];
            if (twin < 0 || parent_[at(twin / 3)] < 0)
                continue;
            part = join(part, find(twin / 3));
            perimeter_[at(part)] -= 2.0 * lengths[at(k)];
        }
        return part;
    }
    double perimeter(Index part) const { return perimeter_[at(part)]; }
    Index tip(Index part) const { return tip_[at(part)]; }
    /// Whether the part's tip has been taken; takes it.
    bool take(Index part) { return std::exchange(found_[at(part)], std::uint8_t{1}) == 0; }

private:
    bool farther(Index a, Index b) const {
        return distance_[at(a)] != distance_[at(b)] ? distance_[at(a)] > distance_[at(b)] : a < b;
    }
    Index find(Index f) {
        while (parent_[at(f)] != f)
            f = parent_[at(f)] = parent_[at(parent_[at(f)])];
        return f;
    }
    Index join(Index a, Index b) {
        if (a == b)
            return a;
        if (farther(tip_[at(b)], tip_[at(a)]))
            std::swap(a, b);
        parent_[at(b)] = a;
        perimeter_[at(a)] += perimeter_[at(b)];
        // The far end of both was far enough for a loop that only one of them has: it stays taken.
        if (tip_[at(a)] == tip_[at(b)])
            found_[at(a)] |= found_[at(b)];
        return a;
    }

    const ChartSurface& s_;
    const std::vector<double>& distance_;
    std::vector<Index> parent_;
    std::vector<double> perimeter_;
    std::vector<Index> tip_; // the farthest vertex
    std::vector<std::uint8_t> found_;
};

} // namespace

std::vector<Index> find_tips(const Mesh& mesh, const ChartSurface& surface,
                             const std::vector<double>& distance, const TipRule& rule,
                             const Progress& progress) {
    Heartbeat beat(progress);
    std::vector<double> level(surface.face.size());
    for (Index f = 0; f < surface.face_count(); ++f)
        level[at(f)] =
            std::min({distance[at(surface.origin(3 * f))], distance[at(surface.origin(3 * f + 1))],
                      distance[at(surface.origin(3 * f + 2))]});
    std::vector<Index> order(surface.face.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](Index a, Index b) {
        return level[at(a)] != level[at(b)] ? level[at(a)] > level[at(b)] : a < b;
    });
    double boundary = 0.0;
    for (const std::vector<Index>& loop : surface.loops)
        boundary += loop_length(mesh, surface, loop);
    Parts parts(surface, distance);
    std::vector<Index> tips;
    for (const Index f : order) {
        beat();
        std::array<double, 3> lengths{};
        for (Index k = 0; k < 3; ++k)
            lengths[at(k)] = mesh.edge_length(surface.mesh_half_edge(3 * f + k));
        const Index part = parts.add(f, lengths);
        const Index tip = parts.tip(part);
        const double loop = parts.perimeter(part);
        const double height = distance[at(tip)] - level[at(f)];
        const bool is_horn = loop <= rule.horn_loop * boundary && height >= horn_height * loop;
        // At the level of the boundary the part is the chart, and its tip the farthest vertex.
        const bool is_end = level[at(f)] <= 0.0 && distance[at(tip)] >= boundary;
        if (height > 0.0 && (is_horn || is_end) && parts.take(part))
            tips.push_back(tip);
    }
    std::sort(tips.begin(), tips.end());
    tips.erase(std::unique(tips.begin(), tips.end()), tips.end());
    return tips;
}

} // namespace devseg::atlas
