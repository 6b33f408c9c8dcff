#include "devseg/mesh/weld.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>

#include "devseg/graph/unions.h"

namespace devseg::mesh {

namespace {

// Faces that form a smaller angle at a common border lie on each other: front and back of a leaf.
// Coordinates of 32 bit turn a face of a thousandth of the model's size by about as much.
constexpr double same_side = 1e-4; // radians

// Cells of the search for near vertices are not smaller, so that their numbers stay in range.
constexpr double smallest_cell = 1e-9;

bool before(const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

// The first vertex at the place of each of these vertices (#points; −1 for all others).
std::vector<Index> exact_places(const std::vector<Vec3>& points, std::vector<Index> vertices) {
    std::sort(vertices.begin(), vertices.end(), [&](Index a, Index b) {
        return points[a] == points[b] ? a < b : before(points[a], points[b]);
    });
    std::vector<Index> first(points.size(), -1);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Index v = vertices[i];
        const bool same = i > 0 && points[v] == points[vertices[i - 1]];
        first[v] = same ? first[vertices[i - 1]] : v;
    }
    return first;
}

std::vector<Index> near_places(const std::vector<Vec3>& points, const std::vector<Index>& vertices,
                               double tolerance) {
    using Cell = std::array<std::int64_t, 3>;
    const double size = std::max(tolerance, smallest_cell);
    std::vector<std::pair<Cell, Index>> cells;
    for (const Index v : vertices) {
        Cell cell;
        for (std::size_t k = 0; k < 3; ++k)
            cell[k] = static_cast<std::int64_t>(std::floor(points[v][static_cast<int>(k)] / size));
        cells.emplace_back(cell, v);
    }
    std::sort(cells.begin(), cells.end());
    graph::Unions one(points.size());
    for (const auto& [cell, v] : cells)
        for (std::int64_t x = cell[0]; x <= cell[0] + 1; ++x)
            for (std::int64_t y = cell[1] - 1; y <= cell[1] + 1; ++y) {
                const std::pair<Cell, Index> from({x, y, cell[2] - 1}, -1);
                for (auto near = std::lower_bound(cells.begin(), cells.end(), from);
                     near != cells.end() && near->first <= Cell{x, y, cell[2] + 1}; ++near)
                    if ((points[near->second] - points[v]).norm() <= tolerance) {
                        const auto [low, high] = std::minmax({one.find(v), one.find(near->second)});
                        one.join(low, high);
                    }
            }
    std::vector<Index> first(points.size(), -1);
    for (const Index v : vertices)
        first[v] = one.find(v);
    return first;
}

std::vector<Index> places(const std::vector<Vec3>& points, std::vector<Index> vertices,
                          double tolerance) {
    return tolerance > 0.0 ? near_places(points, vertices, tolerance)
                           : exact_places(points, std::move(vertices));
}

// A boundary half-edge as others see it that lie on the same two places.
struct Border {
    Index low; // places of its ends, the smaller one first
    Index high;
    HalfEdge h;
    bool forward; // runs from low to high
    bool is_flat; // its face has no area, and so no angle
    double angle; // of the face about the line from low to high, −π to π
};

class BorderPairs {
public:
    BorderPairs(const Mesh& mesh, std::vector<Index> place)
        : mesh_(mesh), place_(std::move(place)) {}

    std::vector<std::array<HalfEdge, 2>> find(const std::vector<std::uint8_t>& left_out) {
        for (const HalfEdge h : mesh_.all_half_edges())
            if (mesh_.twin[h] < 0 && left_out[h] == 0)
                add(h);
        std::sort(borders_.begin(), borders_.end(), [](const Border& a, const Border& b) {
            return std::tie(a.low, a.high, a.h) < std::tie(b.low, b.high, b.h);
        });
        std::vector<std::vector<Border>> uneven;
        for (std::size_t i = 0, j = 0; i < borders_.size(); i = j) {
            while (j < borders_.size() && borders_[i].low == borders_[j].low &&
                   borders_[i].high == borders_[j].high)
                ++j;
            std::vector<Border> group(borders_.begin() + static_cast<std::ptrdiff_t>(i),
                                      borders_.begin() + static_cast<std::ptrdiff_t>(j));
            if (group.size() < 2)
                continue;
            if (is_even(group))
                match(std::move(group));
            else
                uneven.push_back(std::move(group));
        }
        match_within_pieces(uneven);
        return std::move(pairs_);
    }

private:
    const Mesh& mesh_;
    std::vector<Index> place_; // #V, of vertices on the boundary
    std::vector<Border> borders_;
    std::vector<std::array<HalfEdge, 2>> pairs_;

    void add(HalfEdge h) {
        const Index from = place_[mesh_.origin(h)];
        const Index to = place_[mesh_.target(h)];
        const Index apex = place_[mesh_.apex(h)];
        if (from == to || apex == from || apex == to)
            return; // no edge, or a face that would be its own partner
        const Vec3& low = mesh_.points[std::min(from, to)];
        const Vec3 axis = (mesh_.points[std::max(from, to)] - low).normalized();
        const Vec3 arm = axis.cross(mesh_.points[mesh_.apex(h)] - low);
        // Any frame that depends on the axis alone does.
        Vec3::Index thin = 0;
        axis.cwiseAbs().minCoeff(&thin);
        const Vec3 x = axis.cross(Vec3::Unit(thin)).normalized();
        const double angle = std::atan2(axis.cross(x).dot(arm), x.dot(arm));
        borders_.push_back({std::min(from, to), std::max(from, to), h, from < to,
                            !(arm.squaredNorm() > 0.0), angle});
    }

    static bool is_even(const std::vector<Border>& group) {
        const auto forward =
            std::count_if(group.begin(), group.end(), [](const Border& b) { return b.forward; });
        return 2 * static_cast<std::size_t>(forward) == group.size();
    }

    static bool lie_on_each_other(const Border& a, const Border& b) {
        return !a.is_flat && !b.is_flat &&
               std::abs(std::remainder(a.angle - b.angle, 2.0 * pi)) < same_side;
    }

    // Around the line, backward half-edges open the inside of a solid and forward ones close it:
    // pairs are those of brackets. The second round closes what the end of the first has open.
    void match(std::vector<Border> group) {
        std::stable_sort(group.begin(), group.end(),
                         [](const Border& a, const Border& b) { return a.angle < b.angle; });
        std::vector<Border> open;
        std::vector<std::uint8_t> done(group.size(), 0);
        for (std::size_t i = 0; i < 2 * group.size(); ++i) {
            const Border& border = group[i % group.size()];
            if (!border.forward && i < group.size())
                open.push_back(border);
            if (!border.forward || done[i % group.size()] != 0)
                continue;
            const auto partner = std::find_if(open.rbegin(), open.rend(), [&](const Border& other) {
                return !lie_on_each_other(border, other);
            });
            if (partner == open.rend())
                continue;
            pairs_.push_back({border.h, partner->h});
            done[i % group.size()] = 1;
            open.erase(std::next(partner).base());
        }
    }

    // What has no partner on every side, such as a sheet that touches a solid, only leaves those
    // together that other edges hold together already.
    void match_within_pieces(const std::vector<std::vector<Border>>& groups) {
        if (groups.empty())
            return;
        graph::Unions piece(mesh_.faces.size());
        for (const HalfEdge h : mesh_.all_half_edges())
            if (mesh_.twin[h] > h)
                piece.join(piece.find(face_of(h)), piece.find(face_of(mesh_.twin[h])));
        for (const auto& [h, other] : pairs_)
            piece.join(piece.find(face_of(h)), piece.find(face_of(other)));
        for (std::vector<Border> group : groups) {
            const auto piece_of = [&](const Border& b) { return piece.find(face_of(b.h)); };
            std::stable_sort(group.begin(), group.end(), [&](const Border& a, const Border& b) {
                return piece_of(a) < piece_of(b);
            });
            for (auto first = group.begin(); first != group.end();) {
                const auto end = std::find_if(first, group.end(), [&](const Border& b) {
                    return piece_of(b) != piece_of(*first);
                });
                std::vector<Border> own(first, end);
                if (is_even(own))
                    match(std::move(own));
                first = end;
            }
        }
    }
};

} // namespace

Index weld_soup(const std::vector<Vec3>& points, double tolerance, std::vector<Triangle>& faces) {
    std::vector<std::uint8_t> used(points.size(), 0);
    std::vector<Index> vertices;
    for (const Triangle& t : faces)
        for (const Vertex v : t) {
            if (used[v]++ != 0)
                return 0;
            vertices.push_back(v);
        }
    const std::vector<Index> first = places(points, std::move(vertices), tolerance);
    Index less = 0;
    for (Triangle& t : faces)
        for (Index& v : t) {
            less += first[v] != v ? 1 : 0;
            v = first[v];
        }
    return less;
}

std::vector<std::array<HalfEdge, 2>> coincident_borders(const Mesh& mesh,
                                                        const std::vector<std::uint8_t>& left_out,
                                                        double tolerance,
                                                        const Progress& progress) {
    std::vector<std::uint8_t> on_boundary(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] < 0 && left_out[h] == 0)
            for (const Vertex v : mesh.faces[face_of(h)])
                on_boundary[v] = 1;
    std::vector<Index> vertices;
    for (const Vertex v : mesh.all_vertices())
        if (on_boundary[v] != 0)
            vertices.push_back(v);
    progress.check();
    std::vector<Index> place = places(mesh.points, std::move(vertices), tolerance);
    progress.check();
    return BorderPairs(mesh, std::move(place)).find(left_out);
}

} // namespace devseg::mesh
