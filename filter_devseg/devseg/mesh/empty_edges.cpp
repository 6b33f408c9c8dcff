#include "devseg/mesh/empty_edges.h"

#include <algorithm>
#include <array>
#include <utility>

#include "devseg/graph/unions.h"

namespace devseg::mesh {

namespace {

using Edge = std::pair<Index, Index>; // of vertices, the lower one first

Triangle sorted(Triangle t) {
    std::sort(t.begin(), t.end());
    return t;
}

bool repeats_a_vertex(const Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

// Vertices that become one, and those of them that must not.
class Clusters {
public:
    Clusters(const std::vector<Vec3>& points, const std::vector<Triangle>& faces)
        : faces_(faces), unions_(points.size()), apart_(points.size(), 0) {
        for (const Triangle& t : faces)
            for (std::size_t k = 0; k < 3; ++k) {
                const Vertex v = t[k];
                const Vertex w = t[(k + 1) % 3];
                if (v == w || points[v] != points[w])
                    continue;
                const auto [into, other] = std::minmax({unions_.find(v), unions_.find(w)});
                unions_.join(into, other);
                any_ = any_ || into != other;
            }
    }

    bool any() const { return any_; }

    Index joined(Index v) { return apart_[at(unions_.find(v))] != 0 ? v : unions_.find(v); }

    // Keeps those apart that bring different edges or faces together where there is no room for
    // them. False where there are none.
    bool keep_apart() {
        std::vector<std::pair<Triangle, Triangle>> triangles; // joined and given
        std::vector<std::pair<Edge, Edge>> edges;
        for (const Triangle& t : faces_) {
            const Triangle joint{joined(t[0]), joined(t[1]), joined(t[2])};
            if (repeats_a_vertex(joint))
                continue;
            triangles.emplace_back(sorted(joint), sorted(t));
            for (std::size_t k = 0; k < 3; ++k)
                edges.emplace_back(std::minmax({joint[k], joint[(k + 1) % 3]}),
                                   std::minmax({t[k], t[(k + 1) % 3]}));
        }
        const bool lies_on_others = bar(triangles, 1);
        return bar(edges, 2) || lies_on_others;
    }

private:
    template <class Items>
    bool bar(Items& items, std::ptrdiff_t most) {
        std::sort(items.begin(), items.end());
        bool any = false;
        for (auto first = items.begin(); first != items.end();) {
            auto last = first;
            while (last != items.end() && last->first == first->first)
                ++last;
            if (last - first > most && first->second != std::prev(last)->second)
                any = bar_corners(first->first) || any;
            first = last;
        }
        return any;
    }
    bool bar_corners(const Edge& edge) { return bar_at(edge.first) | bar_at(edge.second); }
    bool bar_corners(const Triangle& t) { return bar_at(t[0]) | bar_at(t[1]) | bar_at(t[2]); }
    bool bar_at(Index v) {
        std::uint8_t& apart = apart_[at(unions_.find(v))];
        const bool is_new = apart == 0;
        apart = 1;
        return is_new;
    }

    const std::vector<Triangle>& faces_;
    graph::Unions unions_;
    std::vector<std::uint8_t> apart_; // of the vertex that stands for others
    bool any_ = false;
};

// Faces whose ends stay apart repeat a vertex, each on its own. Not at an edge of more than two
// faces: the others there would become neighbours.
void draw_together(const std::vector<Vec3>& points, std::vector<Triangle>& faces) {
    std::vector<Edge> edges;
    for (const Triangle& t : faces)
        for (std::size_t k = 0; k < 3 && !repeats_a_vertex(t); ++k)
            edges.emplace_back(std::minmax({t[k], t[(k + 1) % 3]}));
    std::sort(edges.begin(), edges.end());
    const auto is_crowded = [&](Index v, Index w) {
        const auto range = std::equal_range(edges.begin(), edges.end(), Edge(std::minmax({v, w})));
        return range.second - range.first > 2;
    };
    for (Triangle& t : faces) {
        if (is_crowded(t[0], t[1]) || is_crowded(t[1], t[2]) || is_crowded(t[2], t[0]))
            continue;
        for (std::size_t k = 0; k < 3; ++k)
            if (points[t[k]] == points[t[(k + 1) % 3]])
                t[(k + 1) % 3] = t[k];
    }
}

} // namespace

Index join_ends_of_empty_edges(const std::vector<Vec3>& points, std::vector<Triangle>& faces) {
    Clusters clusters(points, faces);
    if (!clusters.any())
        return 0;
    while (clusters.keep_apart()) {
    }
    std::vector<std::uint8_t> gone(points.size(), 0);
    std::vector<Triangle> joined = faces;
    for (Triangle& t : joined)
        for (Index& v : t) {
            const Index to = clusters.joined(v);
            gone[at(v)] = to != v ? 1 : 0;
            v = to;
        }
    draw_together(points, joined);
    faces = std::move(joined);
    return static_cast<Index>(std::count(gone.begin(), gone.end(), 1));
}

} // namespace devseg::mesh
