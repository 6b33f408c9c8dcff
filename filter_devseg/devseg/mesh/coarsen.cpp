#include "devseg/mesh/coarsen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "devseg/base/parallel.h"

namespace devseg::mesh {

namespace {

// Weight of the length of the collapsed edge against the distance to the planes around it: flat
// parts lose their vertices evenly, which keeps triangles round.
constexpr double length_weight = 3e-3;
constexpr double boundary_weight = 10.0; // of planes that stand on boundary edges

constexpr double least_turn = 0.3;   // cosine of the angle that a face may turn in one collapse
constexpr double least_shape = 0.05; // of a new triangle; 1 is equilateral, 0 is a needle
constexpr Index check_every = 1 << 14;
constexpr std::size_t most_neighbours = 64; // of a vertex that may be removed, or kept by another

// Σ area (n·x + d)² over planes, as a symmetric form.
struct Quadric {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, x = 0, y = 0, z = 0, c = 0;
    double area = 0;

    void add_plane(const Vec3& n, double d, double weight) {
        xx += weight * n.x() * n.x();
        xy += weight * n.x() * n.y();
        xz += weight * n.x() * n.z();
        yy += weight * n.y() * n.y();
        yz += weight * n.y() * n.z();
        zz += weight * n.z() * n.z();
        x += weight * d * n.x();
        y += weight * d * n.y();
        z += weight * d * n.z();
        c += weight * d * d;
    }
    void add(const Quadric& q) {
        xx += q.xx;
        xy += q.xy;
        xz += q.xz;
        yy += q.yy;
        yz += q.yz;
        zz += q.zz;
        x += q.x;
        y += q.y;
        z += q.z;
        c += q.c;
        area += q.area;
    }
    double operator()(const Vec3& p) const {
        return p.x() * (xx * p.x() + 2.0 * (xy * p.y() + xz * p.z() + x)) +
               p.y() * (yy * p.y() + 2.0 * (yz * p.z() + y)) + p.z() * (zz * p.z() + 2.0 * z) + c;
    }
};

class Coarsener {
public:
    Coarsener(const std::vector<Vec3>& points, CoarseSurface& surface, Progress* shared)
        : points_(points), s_(surface), outgoing_(points.size(), -1), quadric_(points.size()),
          best_(points.size()), stale_(points.size(), 1), touched_(points.size(), 0),
          shared_(shared) {
        for (HalfEdge h = 0; h < static_cast<Index>(s_.twin.size()); ++h)
            outgoing_[origin(h)] = h;
        for (Face f = 0; f < static_cast<Index>(s_.faces.size()); ++f)
            add_face_quadric(f);
    }

    // One round of independent collapses; false if none was possible. A round without any is
    // followed by one that looks at all vertices anew: what happens two edges away can make a
    // collapse legal without making it stale.
    bool round(Index removable, const Progress& progress) {
        choose_candidates(removable, progress);
        std::fill(touched_.begin(), touched_.end(), std::uint8_t{0});
        Index removed = 0;
        for (const Vertex v : order_) {
            if (removed == removable)
                break;
            if (touched_[v] != 0 || !try_collapse(v))
                continue;
            if (++removed % check_every == 0)
                progress.check();
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

    Index origin(HalfEdge h) const { return s_.faces[h / 3][h % 3]; }
    Index target(HalfEdge h) const { return origin(Mesh::next(h)); }

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
            if (s_.twin[h] >= 0)
                continue;
            const Vec3& p = points_[origin(h)];
            const Vec3 edge = points_[target(h)] - p;
            const Vec3 side = edge.cross(n);
            if (!(side.squaredNorm() > 0.0))
                continue;
            const Vec3 m = side.normalized();
            for (const Vertex v : {origin(h), target(h)})
                quadric_[v].add_plane(m, -m.dot(p), boundary_weight * edge.squaredNorm());
        }
    }

    // The cheapest collapse of each vertex whose surroundings changed; then those to try, in order.
    void choose_candidates(Index removable, const Progress& progress) {
        refresh(progress);
        order_.clear();
        for (Vertex v = 0; v < static_cast<Index>(points_.size()); ++v)
            if (outgoing_[v] >= 0 && best_[v].half_edge >= 0)
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
        const auto refresh_part = [&](int part) {
            progress.check();
            for (Vertex v = part * check_every; v < std::min(count, (part + 1) * check_every); ++v)
                if (outgoing_[v] >= 0 && stale_[v] != 0) {
                    best_[v] = cheapest_collapse(v);
                    stale_[v] = 0;
                }
        };
        const int parts = (count + check_every - 1) / check_every;
        if (shared_ != nullptr) {
            parallel_for(parts, refresh_part, *shared_);
        } else {
            for (int part = 0; part < parts; ++part)
                refresh_part(part);
        }
    }

    // Legality is dearer than the cost: it is asked for in the order of costs.
    Candidate cheapest_collapse(Vertex v) const {
        std::array<Candidate, most_neighbours> candidates;
        std::size_t count = 0;
        Ring around_v;
        const bool inner = gather_ring(v, around_v);
        visit_star(s_.twin, outgoing_[v], [&](HalfEdge h) {
            if (count == candidates.size() || (!inner && s_.twin[h] >= 0))
                return;
            const Vec3& p = points_[target(h)];
            candidates[count].half_edge = h;
            candidates[count++].cost =
                std::max(0.0, quadric_[v](p) + quadric_[target(h)](p)) +
                length_weight * quadric_[v].area * (p - points_[v]).squaredNorm();
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
        std::array<Index, most_neighbours> vertex;
        std::size_t size = 0;
        void add(Vertex v) {
            if (size < vertex.size())
                vertex[size++] = v;
        }
    };
    bool is_legal(HalfEdge h) const {
        Ring around_v;
        const bool inner_v = gather_ring(origin(h), around_v);
        return is_legal(h, around_v, inner_v);
    }
    bool is_legal(HalfEdge h, const Ring& around_v, bool inner_v) const {
        return keeps_topology(h, around_v, inner_v) && keeps_shape(h);
    }

    // The link condition: the ends of the edge have no common neighbours but the two opposite
    // vertices, which must keep three faces (a boundary vertex, one).
    bool keeps_topology(HalfEdge h, const Ring& around_v, bool inner_v) const {
        const Index w = target(h);
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
    bool gather_ring(Index u, Ring& ring) const {
        return visit_star(s_.twin, outgoing_[u], [&](Index k) {
            ring.add(target(k));
            if (s_.twin[Mesh::previous(k)] < 0)
                ring.add(origin(Mesh::previous(k)));
        });
    }
    // The vertex opposite to the edge has a face besides this one, and an inner one three.
    bool keeps_apex(HalfEdge h) const {
        const Index toward = Mesh::next(h);
        const Index back = Mesh::previous(h);
        if (s_.twin[toward] < 0 && s_.twin[back] < 0)
            return false;
        Index faces = 0;
        const bool inner = visit_star(s_.twin, back, [&](Index) { ++faces; });
        return !inner || faces > 3;
    }
    bool keeps_shape(HalfEdge h) const {
        const Vertex v = origin(h);
        const Vec3& p = points_[target(h)];
        const Face face = h / 3;
        const Index other = s_.twin[h] < 0 ? -1 : s_.twin[h] / 3;
        bool good = true;
        visit_star(s_.twin, h, [&](Index k) {
            if (!good || k / 3 == face || k / 3 == other)
                return;
            const Vec3& a = points_[target(k)];
            const Vec3& b = points_[origin(Mesh::previous(k))];
            const Vec3 old = (a - points_[v]).cross(b - points_[v]);
            const Vec3 now = (a - p).cross(b - p);
            const double size = now.norm();
            const double lengths =
                (a - p).squaredNorm() + (b - p).squaredNorm() + (a - b).squaredNorm();
            good = old.dot(now) >= least_turn * old.norm() * size &&
                   2.0 * std::sqrt(3.0) * size > least_shape * lengths;
        });
        return good;
    }

    bool try_collapse(Vertex v) {
        const HalfEdge h = best_[v].half_edge;
        const Index w = target(h);
        if (!is_legal(h)) { // a collapse nearby changed the surroundings of the kept vertex
            stale_[v] = 1;
            return false;
        }
        quadric_[w].add(quadric_[v]);
        visit_star(s_.twin, h, [&](Index k) {
            touch(target(k));
            touch(origin(Mesh::previous(k)));
        });
        collapse(h);
        outgoing_[v] = -1;
        return true;
    }
    void touch(Vertex v) { touched_[v] = stale_[v] = 1; }

    void collapse(HalfEdge h) {
        const Index w = target(h);
        const HalfEdge twin = s_.twin[h];
        visit_star(s_.twin, h, [&](Index k) {
            if (k / 3 != h / 3 && (twin < 0 || k / 3 != twin / 3))
                s_.faces[k / 3][k % 3] = w;
        });
        take_out(h);
        if (twin >= 0)
            take_out(twin);
        s_.collapses.push_back(h);
    }
    // Removes the face of h and joins its two other edges.
    void take_out(HalfEdge h) {
        const Index first = s_.twin[Mesh::next(h)];
        const Index second = s_.twin[Mesh::previous(h)];
        if (first >= 0)
            s_.twin[first] = second;
        if (second >= 0)
            s_.twin[second] = first;
        s_.alive[h / 3] = 0;
        --s_.alive_faces;
        for (const Index k : {first, second})
            if (k >= 0) { // between the apex and the kept vertex
                outgoing_[origin(k)] = k;
                outgoing_[target(k)] = Mesh::next(k);
            }
    }

    const std::vector<Vec3>& points_;
    CoarseSurface& s_;
    std::vector<Index> outgoing_; // #V: a half-edge that leaves the vertex, −1 once it is removed
    std::vector<Quadric> quadric_;
    std::vector<Candidate> best_;
    std::vector<std::uint8_t> stale_;   // #V: best_ must be found again
    std::vector<std::uint8_t> touched_; // #V: a neighbour was removed in this round
    Progress* shared_;                  // of the whole run, where more threads may be used
    bool thorough_ = false;             // the last round removed nothing
    std::vector<Index> order_;          // candidates, the cheapest first
};

} // namespace

namespace {

CoarseSurface coarsen_with(const std::vector<Vec3>& points, const std::vector<Triangle>& faces,
                           const std::vector<HalfEdge>& twin, Index target_faces,
                           const Progress& progress, Progress* shared) {
    CoarseSurface surface;
    surface.faces = faces;
    surface.twin = twin;
    surface.alive.assign(faces.size(), 1);
    surface.alive_faces = static_cast<Index>(faces.size());
    if (surface.alive_faces <= target_faces)
        return surface;
    Coarsener coarsener(points, surface, shared);
    while (surface.alive_faces > target_faces &&
           coarsener.round((surface.alive_faces - target_faces + 1) / 2, progress)) {
    }
    return surface;
}

} // namespace

CoarseSurface coarsen(const std::vector<Vec3>& points, const std::vector<Triangle>& faces,
                      const std::vector<HalfEdge>& twin, Index target_faces,
                      const Progress& progress) {
    return coarsen_with(points, faces, twin, target_faces, progress, nullptr);
}

CoarseSurface coarsen_in_parallel(const Mesh& mesh, Index target_faces, Progress& progress) {
    return coarsen_with(mesh.points, mesh.faces, mesh.twin, target_faces, progress, &progress);
}

Index undo_collapse(CoarseSurface& s) {
    const HalfEdge h = s.collapses.back();
    s.collapses.pop_back();
    const HalfEdge twin = s.twin[h];
    for (const Index side : {twin, h}) {
        if (side < 0)
            continue;
        s.alive[side / 3] = 1;
        ++s.alive_faces;
        for (const Index k : {Mesh::next(side), Mesh::previous(side)})
            if (s.twin[k] >= 0)
                s.twin[s.twin[k]] = k;
    }
    const Vertex v = s.faces[h / 3][h % 3];
    visit_star(s.twin, h, [&](Index k) { s.faces[k / 3][k % 3] = v; });
    return h;
}

CoarseMesh extract_coarse_mesh(const Mesh& fine, const CoarseSurface& surface) {
    CoarseMesh result;
    std::vector<Index> number(surface.faces.size(), -1);
    std::vector<Index> vertex(fine.points.size(), -1);
    for (const Face f : fine.all_faces()) {
        if (surface.alive[f] == 0)
            continue;
        number[f] = static_cast<Index>(result.face.size());
        result.face.push_back(f);
        Triangle t{};
        for (std::size_t k = 0; k < 3; ++k) {
            const Vertex v = surface.faces[f][k];
            if (vertex[v] < 0) {
                vertex[v] = static_cast<Index>(result.vertex.size());
                result.vertex.push_back(v);
                result.mesh.points.push_back(fine.points[v]);
            }
            t[k] = vertex[v];
        }
        result.mesh.faces.push_back(t);
    }
    for (const Face f : result.face)
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge twin = surface.twin[h];
            result.mesh.twin.push_back(twin < 0 ? -1 : 3 * number[twin / 3] + twin % 3);
        }
    result.mesh.unit_length = fine.unit_length;
    compute_face_geometry(result.mesh);
    return result;
}

namespace {

// Length of the borders around the two faces beside h, had they these labels.
double border_length(const std::vector<Vec3>& points, const CoarseSurface& s, HalfEdge h,
                     const std::vector<Index>& label, Index here, Index there) {
    const auto length = [&](Index k) {
        return (points[s.faces[k / 3][k % 3]] - points[s.faces[k / 3][Mesh::next(k) % 3]]).norm();
    };
    const HalfEdge twin = s.twin[h];
    double sum = twin >= 0 && here != there ? length(h) : 0.0;
    for (const auto& [side, own] : {std::pair(h, here), std::pair(twin, there)})
        if (side >= 0)
            for (const Index k : {Mesh::next(side), Mesh::previous(side)}) {
                const Index across = s.twin[k];
                if (across >= 0 && label[across / 3] != own)
                    sum += length(k);
            }
    return sum;
}

} // namespace

std::vector<Index> refine_labels(const std::vector<Vec3>& points, CoarseSurface surface,
                                 std::vector<Index> label, const Progress& progress) {
    Heartbeat beat(progress);
    const auto across = [&](Index k) {
        const HalfEdge twin = surface.twin[k];
        return twin < 0 ? -1 : label[twin / 3];
    };
    while (!surface.collapses.empty()) {
        beat();
        const HalfEdge h = undo_collapse(surface);
        const HalfEdge twin = surface.twin[h];
        double shortest = -1.0;
        Index best_here = -1;
        Index best_there = -1;
        for (const Index a : {across(Mesh::next(h)), across(Mesh::previous(h))})
            for (const Index b : {twin < 0 ? a : across(Mesh::next(twin)),
                                  twin < 0 ? a : across(Mesh::previous(twin))}) {
                if (a < 0 || b < 0)
                    continue;
                const double length = border_length(points, surface, h, label, a, b);
                if (shortest < 0.0 || length < shortest) {
                    shortest = length;
                    best_here = a;
                    best_there = b;
                }
            }
        label[h / 3] = best_here;
        if (twin >= 0)
            label[twin / 3] = best_there;
    }
    return label;
}

} // namespace devseg::mesh
