#include "devseg/mesh/coarsen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "devseg/base/parallel.h"

namespace devseg::mesh {

namespace {

struct Tuning {
    // Of the length of the collapsed edge against the distance to the planes around it: flat parts
    // lose their vertices evenly, which keeps triangles round.
    double length_weight = 3e-3;
    double boundary_weight = 10.0;    // of planes that stand on boundary edges
    double least_turn = 0.3;          // cosine of the angle that a face may turn in one collapse
    double least_shape = 0.05;        // of a new triangle; 1 is equilateral, 0 is a needle
    std::size_t most_neighbours = 64; // of a vertex that may be removed, or kept by another
};
constexpr Tuning tuning;

// Σ area (n·x + d)² over planes, as a symmetric form of (1, x, y, z).
struct Quadric {
    std::array<double, 10> upper{}; // half of its matrix, row by row
    double area = 0.0;

    void add_plane(const Vec3& n, double d, double weight) {
        const std::array<double, 4> plane{d, n.x(), n.y(), n.z()};
        for (std::size_t i = 0, entry = 0; i < 4; ++i)
            for (std::size_t k = i; k < 4; ++k)
                upper[entry++] += weight * plane[i] * plane[k];
    }
    void add(const Quadric& other) {
        for (std::size_t i = 0; i < upper.size(); ++i)
            upper[i] += other.upper[i];
        area += other.area;
    }
    double operator()(const Vec3& p) const {
        const auto& [c, x, y, z, xx, xy, xz, yy, yz, zz] = upper;
        return p.x() * (xx * p.x() + 2.0 * (xy * p.y() + xz * p.z() + x)) +
               p.y() * (yy * p.y() + 2.0 * (yz * p.z() + y)) + p.z() * (zz * p.z() + 2.0 * z) + c;
    }
};

class Coarsener {
public:
    // `fixed`: #V, 1 for vertices that stay.
    Coarsener(const std::vector<Vec3>& points, CoarseSurface& surface,
              std::vector<std::uint8_t> fixed, Progress* shared)
        : points_(points), s_(surface), leaving_(points.size(), -1), quadric_(points.size()),
          best_(points.size()), stale_(points.size(), 1), touched_(points.size(), 0),
          fixed_(std::move(fixed)), shared_(shared) {
        for (const HalfEdge h : s_.all_half_edges())
            leaving_[s_.origin(h)] = h;
        if (!s_.line.empty())
            fix_nodes();
        for (const Face f : s_.all_faces())
            add_face_quadric(f);
    }

    // One round of independent collapses; false if none was possible. A round without any is
    // followed by one that looks at all vertices anew: what happens two edges away can make a
    // collapse legal without making it stale.
    bool round(Index removable, const Progress& progress) {
        choose_candidates(removable, progress);
        std::fill(touched_.begin(), touched_.end(), std::uint8_t{0});
        Heartbeat beat(progress);
        Index removed = 0;
        for (const Vertex v : order_) {
            beat();
            if (removed == removable)
                break;
            removed += touched_[v] == 0 && try_collapse(v) ? 1 : 0;
        }
        if (removed == 0 && thorough_)
            return false;
        thorough_ = removed == 0;
        if (thorough_)
            std::fill(stale_.begin(), stale_.end(), std::uint8_t{1});
        else
            s_.rounds.push_back(s_.collapses.size());
        return true;
    }

private:
    struct Candidate {
        double cost = 0.0;
        HalfEdge half_edge = -1;
    };

    bool is_fixed(Vertex v) const { return !fixed_.empty() && fixed_[v] != 0; }
    bool is_line(HalfEdge h) const { return !s_.line.empty() && s_.line[h] >= 0; }

    // Vertices on lines stay where not just two edges of one line meet.
    void fix_nodes() {
        fixed_.resize(points_.size(), 0);
        on_line_.assign(points_.size(), 0);
        std::vector<std::uint8_t> ends(points_.size(), 0); // of half-edges that leave: up to 3
        for (const HalfEdge h : s_.all_half_edges())
            if (is_line(h)) {
                const Vertex v = s_.origin(h);
                ends[v] = std::min<std::uint8_t>(3, ends[v] + 1);
                on_line_[v] = 1;
            }
        for (const HalfEdge h : s_.all_half_edges())
            if (s_.twin[h] < 0)
                for (const Vertex v : {s_.origin(h), s_.target(h)})
                    ends[v] = on_line_[v] != 0 ? 3 : 0;
        for (std::size_t v = 0; v < ends.size(); ++v)
            if (on_line_[v] != 0 && ends[v] != 2)
                fixed_[v] = 1;
    }

    // A vertex on a line goes along it; the last face of a region stays.
    bool keeps_lines(HalfEdge h) const {
        if (s_.line.empty())
            return true;
        if (on_line_[s_.origin(h)] != 0 && !is_line(h))
            return false;
        const auto is_rim = [&](HalfEdge k) { return s_.twin[k] < 0 || is_line(k); };
        const HalfEdge twin = s_.twin[h];
        return !(is_rim(Mesh::next(h)) && is_rim(Mesh::previous(h))) &&
               (twin < 0 || !(is_rim(Mesh::next(twin)) && is_rim(Mesh::previous(twin))));
    }

    void add_face_quadric(Face f) {
        const Triangle& t = s_.faces[f];
        const Vec3& a = points_[t[0]];
        const Vec3 normal = (points_[t[1]] - a).cross(points_[t[2]] - a);
        const double length = normal.norm();
        if (!(length > 0.0))
            return;
        const Vec3 n = normal / length;
        for (const Vertex v : t) {
            quadric_[v].add_plane(n, -n.dot(a), 0.5 * length);
            quadric_[v].area += 0.5 * length;
        }
        for (const HalfEdge h : half_edges_of(f)) {
            if (s_.twin[h] >= 0 && !is_line(h))
                continue;
            const Vec3& p = points_[s_.origin(h)];
            const Vec3 edge = points_[s_.target(h)] - p;
            const Vec3 side = edge.cross(n);
            if (!(side.squaredNorm() > 0.0))
                continue;
            const Vec3 m = side.normalized();
            for (const Vertex v : {s_.origin(h), s_.target(h)})
                quadric_[v].add_plane(m, -m.dot(p), tuning.boundary_weight * edge.squaredNorm());
        }
    }

    // The cheapest collapse of each vertex whose surroundings changed; then those to try, in order.
    void choose_candidates(Index removable, const Progress& progress) {
        refresh(progress);
        order_.clear();
        for (Vertex v = 0; v < static_cast<Index>(points_.size()); ++v)
            if (leaving_[v] >= 0 && best_[v].half_edge >= 0)
                order_.push_back(v);
        const auto cheaper = [&](Index a, Index b) {
            return best_[a].cost != best_[b].cost ? best_[a].cost < best_[b].cost : a < b;
        };
        // The dearer half waits: what goes next to a vertex may make it cheaper.
        const std::size_t count =
            thorough_ ? order_.size() : std::min((order_.size() + 1) / 2, 8 * at(removable));
        std::nth_element(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(count),
                         order_.end(), cheaper);
        order_.resize(count);
        std::sort(order_.begin(), order_.end(), cheaper);
    }

    // Finds the best collapses again where surroundings changed.
    void refresh(const Progress& progress) {
        const Index count = static_cast<Index>(points_.size());
        const auto parts = static_cast<int>(std::sqrt(count)) + 1; // as many as vertices in each
        const auto refresh_part = [&](int part) {
            progress.check();
            for (Vertex v = part * parts; v < std::min(count, (part + 1) * parts); ++v)
                if (leaving_[v] >= 0 && stale_[v] != 0) {
                    best_[v] = is_fixed(v) ? Candidate() : cheapest_collapse(v);
                    stale_[v] = 0;
                }
        };
        if (shared_ != nullptr)
            parallel_for(parts, refresh_part, *shared_);
        else
            for (int part = 0; part < parts; ++part)
                refresh_part(part);
    }

    // Legality is dearer than the cost: it is asked for in the order of costs.
    Candidate cheapest_collapse(Vertex v) const {
        std::array<Candidate, tuning.most_neighbours> candidates;
        std::size_t count = 0;
        Ring around_v;
        const bool inner = gather_ring(v, around_v);
        visit_star(s_, leaving_[v], [&](HalfEdge h) {
            if (count == candidates.size() || (!inner && s_.twin[h] >= 0))
                return;
            const Vertex w = s_.target(h);
            candidates[count].half_edge = h;
            candidates[count++].cost =
                std::max(0.0, quadric_[v](points_[w]) + quadric_[w](points_[w])) +
                tuning.length_weight * quadric_[v].area * (points_[w] - points_[v]).squaredNorm();
        });
        for (auto end = candidates.begin() + static_cast<std::ptrdiff_t>(count);
             end != candidates.begin(); --end) {
            const auto least = std::min_element(
                candidates.begin(), end,
                [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
            if (is_legal(least->half_edge, around_v, inner))
                return *least;
            std::move(least + 1, end, least); // in their order, as ties go to the first
        }
        return {};
    }

    struct Ring {
        std::array<Index, tuning.most_neighbours> vertex;
        std::size_t size = 0;
        void add(Vertex v) {
            if (size < vertex.size())
                vertex[size++] = v;
        }
    };
    bool is_legal(HalfEdge h) const {
        Ring around_v;
        const bool inner_v = gather_ring(s_.origin(h), around_v);
        return is_legal(h, around_v, inner_v);
    }
    bool is_legal(HalfEdge h, const Ring& around_v, bool inner_v) const {
        return keeps_lines(h) && keeps_topology(h, around_v, inner_v) && keeps_shape(h);
    }

    // The link condition: the ends of the edge have no common neighbours but the two opposite
    // vertices, which must keep three faces (a boundary vertex, one).
    bool keeps_topology(HalfEdge h, const Ring& around_v, bool inner_v) const {
        const Vertex w = s_.target(h);
        const HalfEdge twin = s_.twin[h];
        if (!keeps_apex(h) || (twin >= 0 && !keeps_apex(twin)))
            return false;
        Ring around_w;
        const bool inner_w = gather_ring(w, around_w);
        if (!inner_v && !inner_w && twin >= 0)
            return false; // an edge through the inside that joins two boundary vertices
        if (around_v.size == around_v.vertex.size() || around_w.size == around_w.vertex.size())
            return false; // a hub: it may stay
        Index common = 0;
        for (std::size_t i = 0; i < around_v.size; ++i)
            for (std::size_t k = 0; k < around_w.size; ++k)
                common += around_v.vertex[i] == around_w.vertex[k] ? 1 : 0;
        return common == (twin >= 0 ? 2 : 1);
    }
    bool gather_ring(Vertex u, Ring& ring) const {
        return visit_star(s_, leaving_[u], [&](HalfEdge k) {
            ring.add(s_.target(k));
            if (s_.twin[Mesh::previous(k)] < 0)
                ring.add(s_.apex(k));
        });
    }
    // The vertex opposite to the edge has a face besides this one, and an inner one three.
    bool keeps_apex(HalfEdge h) const {
        const HalfEdge back = Mesh::previous(h);
        if (s_.twin[Mesh::next(h)] < 0 && s_.twin[back] < 0)
            return false;
        Index faces = 0;
        const bool inner = visit_star(s_, back, [&](Index) { ++faces; });
        return !inner || faces > 3;
    }
    bool keeps_shape(HalfEdge h) const {
        const Vec3& v = points_[s_.origin(h)];
        const Vec3& p = points_[s_.target(h)];
        const Face face = face_of(h);
        const Face other = s_.across(h);
        bool good = true;
        visit_star(s_, h, [&](HalfEdge k) {
            if (!good || face_of(k) == face || face_of(k) == other)
                return;
            const Vec3& a = points_[s_.target(k)];
            const Vec3& b = points_[s_.apex(k)];
            const Vec3 old = (a - v).cross(b - v);
            const Vec3 now = (a - p).cross(b - p);
            const double size = now.norm();
            const double lengths =
                (a - p).squaredNorm() + (b - p).squaredNorm() + (a - b).squaredNorm();
            good = old.dot(now) >= tuning.least_turn * old.norm() * size &&
                   2.0 * std::sqrt(3.0) * size > tuning.least_shape * lengths;
        });
        return good;
    }

    bool try_collapse(Vertex v) {
        const HalfEdge h = best_[v].half_edge;
        const Vertex w = s_.target(h);
        if (!is_legal(h)) { // a collapse nearby changed the surroundings of the kept vertex
            stale_[v] = 1;
            return false;
        }
        quadric_[w].add(quadric_[v]);
        visit_star(s_, h, [&](HalfEdge k) {
            touch(s_.target(k));
            touch(s_.apex(k));
        });
        join_lines(h);
        collapse(h);
        leaving_[v] = -1;
        return true;
    }
    void touch(Vertex v) { touched_[v] = stale_[v] = 1; }

    // The edge of a line that collapses becomes part of the next one.
    void join_lines(HalfEdge h) {
        if (!is_line(h))
            return;
        Index into = -1;
        visit_star(s_, h, [&](HalfEdge k) {
            if (k != h && is_line(k))
                into = s_.line[k];
        });
        s_.line[s_.line[h]] = into;
    }

    void collapse(HalfEdge h) {
        const Vertex w = s_.target(h);
        const HalfEdge twin = s_.twin[h];
        visit_star(s_, h, [&](HalfEdge k) {
            if (face_of(k) != face_of(h) && face_of(k) != s_.across(h))
                s_.faces[face_of(k)][corner_of(k)] = w;
        });
        take_out(h);
        if (twin >= 0)
            take_out(twin);
        s_.collapses.push_back(h);
    }
    // Removes the face of h and joins its two other edges.
    void take_out(HalfEdge h) {
        const HalfEdge first = s_.twin[Mesh::next(h)];
        const HalfEdge second = s_.twin[Mesh::previous(h)];
        if (first >= 0)
            s_.twin[first] = second;
        if (second >= 0)
            s_.twin[second] = first;
        if (!s_.line.empty() && first >= 0 && second >= 0)
            s_.line[first] = s_.line[second] = std::max(s_.line[first], s_.line[second]);
        s_.alive[face_of(h)] = 0;
        --s_.alive_faces;
        for (const HalfEdge k : {first, second})
            if (k >= 0) { // between the apex and the kept vertex
                leaving_[s_.origin(k)] = k;
                leaving_[s_.target(k)] = Mesh::next(k);
            }
    }

    const std::vector<Vec3>& points_;
    CoarseSurface& s_;
    std::vector<Index> leaving_; // #V: a half-edge that leaves the vertex, −1 once it is removed
    std::vector<Quadric> quadric_;
    std::vector<Candidate> best_;
    std::vector<std::uint8_t> stale_;   // #V: best_ must be found again
    std::vector<std::uint8_t> touched_; // #V: a neighbour was removed in this round
    std::vector<std::uint8_t> fixed_;   // #V: stays; empty: all may go
    std::vector<std::uint8_t> on_line_; // #V; empty where there are no lines
    Progress* shared_;                  // of the whole run, where more threads may be used
    bool thorough_ = false;             // the last round removed nothing
    std::vector<Index> order_;          // candidates, the cheapest first
};

CoarseSurface whole_surface(const Mesh& fine) {
    CoarseSurface surface{{fine.faces, fine.twin}, {}, {}, {}, {}, fine.face_count()};
    surface.alive.assign(fine.faces.size(), 1);
    return surface;
}

CoarseMesh coarsen_with(const Mesh& fine, CoarseSurface surface, Index target_faces,
                        const std::vector<std::uint8_t>& fixed, const Progress& progress,
                        Progress* shared) {
    if (surface.alive_faces > target_faces) {
        Coarsener coarsener(fine.points, surface, fixed, shared);
        while (surface.alive_faces > target_faces &&
               coarsener.round((surface.alive_faces - target_faces + 1) / 2, progress)) {
        }
    }
    return extract_coarse_mesh(fine, std::move(surface));
}

} // namespace

CoarseMesh coarsen(const Mesh& fine, Index target_faces, const Progress& progress) {
    return coarsen_with(fine, whole_surface(fine), target_faces, {}, progress, nullptr);
}

CoarseMesh coarsen_in_parallel(const Mesh& fine, Index target_faces, Progress& progress) {
    return coarsen_with(fine, whole_surface(fine), target_faces, {}, progress, &progress);
}

CoarseMesh coarsen_between_lines(const Mesh& fine, Index target_faces,
                                 const std::vector<std::uint8_t>& lines,
                                 const std::vector<std::uint8_t>& fixed, Progress& progress) {
    CoarseSurface surface = whole_surface(fine);
    surface.line.assign(fine.twin.size(), -1);
    for (const HalfEdge h : fine.all_half_edges())
        if (lines[h] != 0 && fine.twin[h] >= 0)
            surface.line[h] = std::min<Index>(h, fine.twin[h]);
    CoarseMesh coarse =
        coarsen_with(fine, std::move(surface), target_faces, fixed, progress, &progress);
    std::vector<Index>& line = coarse.surface.line;
    for (const HalfEdge h : fine.all_half_edges()) {
        if (lines[h] == 0 || fine.twin[h] < 0)
            continue;
        Index root = line[h];
        while (line[root] != root)
            root = line[root];
        line[h] = root;
    }
    return coarse;
}

} // namespace devseg::mesh
