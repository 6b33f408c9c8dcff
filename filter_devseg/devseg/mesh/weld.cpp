#include "devseg/mesh/weld.h"

#include <algorithm>
#include <array>
#include <utility>

#include "devseg/graph/unions.h"

namespace devseg::mesh {

namespace {

bool before(const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

struct Edge {
    Index from; // the end that comes first: by its index, later by its place
    Index to;
};

// Edges with one face.
std::vector<Edge> border_edges(const RawMesh& raw) {
    std::vector<Edge> edges;
    for (const Triangle& t : raw.faces)
        for (std::size_t k = 0; k < 3; ++k)
            edges.push_back({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
    const auto less = [](const Edge& a, const Edge& b) {
        return std::pair(a.from, a.to) < std::pair(b.from, b.to);
    };
    std::sort(edges.begin(), edges.end(), less);
    std::vector<Edge> border;
    for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
        while (j < edges.size() && !less(edges[i], edges[j]))
            ++j;
        if (j == i + 1 && edges[i].from != edges[i].to)
            border.push_back(edges[i]);
    }
    return border;
}

// Faces with three different vertices that lie on those of another face.
std::size_t count_duplicates(const std::vector<Triangle>& faces) {
    std::vector<Triangle> sorted;
    for (Triangle t : faces) {
        std::sort(t.begin(), t.end());
        if (t[0] != t[1] && t[1] != t[2])
            sorted.push_back(t);
    }
    std::sort(sorted.begin(), sorted.end());
    const auto end = std::unique(sorted.begin(), sorted.end());
    return static_cast<std::size_t>(sorted.end() - end);
}

} // namespace

Index weld_soup(const RawMesh& raw, std::vector<Triangle>& faces) {
    std::vector<std::uint8_t> used(raw.points.size(), 0);
    std::vector<Index> corners;
    for (const Triangle& t : faces)
        for (const Vertex v : t) {
            if (used[v]++ != 0)
                return 0;
            corners.push_back(v);
        }
    const auto place = [&](Vertex v) -> const Vec3& { return raw.points[v]; };
    std::sort(corners.begin(), corners.end(), [&](Index a, Index b) {
        return place(a) == place(b) ? a < b : before(place(a), place(b));
    });
    std::vector<Index> first(raw.points.size(), -1);
    Index less = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const bool same = i > 0 && place(corners[i]) == place(corners[i - 1]);
        first[corners[i]] = same ? first[corners[i - 1]] : corners[i];
        less += same ? 1 : 0;
    }
    for (Triangle& t : faces)
        for (Index& v : t)
            v = first[v];
    return less;
}

WeldedMesh weld_borders(const RawMesh& raw) {
    const auto place = [&](Vertex v) -> const Vec3& { return raw.points[v]; };
    std::vector<Edge> edges = border_edges(raw);
    for (Edge& edge : edges)
        if (before(place(edge.to), place(edge.from)))
            std::swap(edge.from, edge.to);
    const auto less = [&](const Edge& a, const Edge& b) {
        if (before(place(a.from), place(b.from)) || before(place(b.from), place(a.from)))
            return before(place(a.from), place(b.from));
        return before(place(a.to), place(b.to));
    };
    std::stable_sort(edges.begin(), edges.end(), less);
    WeldedMesh welded{raw, 0};
    graph::Unions one(raw.points.size()); // vertices that are one: the first stands for all
    const auto join = [&](Vertex v, Vertex w) {
        const auto [first, second] = std::minmax({one.find(v), one.find(w)});
        one.join(first, second);
    };
    for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
        while (j < edges.size() && !less(edges[i], edges[j]))
            ++j;
        if (j != i + 2 || place(edges[i].from) == place(edges[i].to))
            continue;
        join(edges[i].from, edges[i + 1].from);
        join(edges[i].to, edges[i + 1].to);
        ++welded.edges;
    }
    for (Triangle& t : welded.mesh.faces)
        for (Index& v : t)
            v = one.find(v);
    if (welded.edges > 0 && count_duplicates(welded.mesh.faces) > count_duplicates(raw.faces))
        return {raw, 0};
    return welded;
}

} // namespace devseg::mesh
