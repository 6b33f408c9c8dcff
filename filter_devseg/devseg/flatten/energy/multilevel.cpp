#include "devseg/flatten/energy/multilevel.h"

#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/LU>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/vertex_relaxation.h"
#include "devseg/mesh/coarsen.h"
#include "devseg/plane/plane.h"

namespace devseg::flatten {

namespace {

struct Tuning {
    int sweeps = 3;               // over all vertices at the end of a level
    double least_new_area = 1e-2; // area of a new face over that of its rest triangle
};
constexpr Tuning tuning;

class Refinement {
public:
    Refinement(const Mesh& mesh, mesh::CoarseSurface coarse, std::vector<Vec2> uv)
        : mesh_(mesh), s_(std::move(coarse)), uv_(std::move(uv)), leaving_(mesh.points.size(), -1) {
        for (const HalfEdge h : mesh.all_half_edges())
            if (s_.alive[face_of(h)] != 0)
                leaving_[origin(h)] = h;
        for (const Vertex v : mesh.all_vertices())
            if (leaving_[v] >= 0)
                alive_.push_back(v);
    }

    bool done() const { return s_.collapses.empty(); }

    // Puts vertices back until there are twice as many.
    void refine(const Progress& progress) {
        Heartbeat heartbeat(progress);
        const std::size_t wanted = 2 * alive_.size();
        while (!done() && alive_.size() < wanted) {
            insert(mesh::undo_collapse(s_));
            heartbeat();
        }
        // A level that would add little more is joined to this one.
        if (s_.collapses.size() < alive_.size() / 4)
            while (!done())
                insert(mesh::undo_collapse(s_));
    }

    // `rest` has the areas and cotangents of the full chart; other levels measure their own faces.
    void relax(const FlatteningProblem* rest, bool hold_boundary, const Progress& progress) {
        measure(rest);
        Heartbeat heartbeat(progress);
        for (int i = 0; i < tuning.sweeps; ++i)
            for (const Vertex v : alive_) {
                heartbeat();
                if (hold_boundary && !mesh::visit_star(s_.twin, leaving_[v], [](HalfEdge) {}))
                    continue;
                gather_star({s_.faces, s_.twin, area_, cotangent_}, uv_, leaving_[v], star_);
                uv_[v] = relax_vertex(star_, uv_[v]);
            }
    }

    std::vector<Vec2> take() { return std::move(uv_); }

private:
    Vertex origin(HalfEdge h) const { return s_.faces[face_of(h)][corner_of(h)]; }

    void insert(HalfEdge h) {
        const Vertex v = origin(h);
        alive_.push_back(v);
        mesh::visit_star(s_.twin, h, [&](HalfEdge k) {
            for (const HalfEdge side : {k, Mesh::next(k), Mesh::previous(k)})
                leaving_[origin(side)] = side;
        });
        leaving_[v] = h;
        gather_shape(v);
        Vec2 p = affine_guess();
        if (!has_room(p)) {
            const Vec2 middle = kernel_point(star_, p);
            // The middle of the kernel is valid: so many halvings of the way end there.
            const int halvings = std::numeric_limits<double>::digits;
            for (int i = 0; i < halvings && !std::isfinite(star_.energy(p)); ++i)
                p = 0.5 * (p + middle);
            if (!(star_.energy(p) <= star_.energy(middle)))
                p = middle;
            if (!std::isfinite(star_.energy(p)))
                throw NumericalFailure("expected room for a vertex of a refined map, found none");
        }
        uv_[v] = p;
    }

    bool has_room(const Vec2& p) const {
        for (const VertexStar::Face& f : star_.faces) {
            if (!(plane::cross(f.from - p, f.to - p) > 2.0 * tuning.least_new_area * f.area))
                return false;
        }
        return true;
    }

    // The star with rest shapes from the faces as they are now, and its corners laid out in the
    // plane around the vertex: lengths kept, angles scaled to a full turn if the star is closed.
    void gather_shape(Vertex v) {
        star_.faces.clear();
        ring_.clear();
        double turn = 0.0;
        HalfEdge first = leaving_[v];
        while (s_.twin[first] >= 0) { // to the end of an open star, or once around
            first = Mesh::next(s_.twin[first]);
            if (first == leaving_[v])
                break;
        }
        const Vec3& p = mesh_.points[v];
        HalfEdge k = first;
        bool closed = false;
        while (true) {
            const Vertex a = origin(Mesh::next(k));
            const Vertex b = origin(Mesh::previous(k));
            const Vec3 ea = mesh_.points[a] - p;
            const Vec3 eb = mesh_.points[b] - p;
            ring_.push_back({turn, ea.norm(), uv_[a]});
            turn += std::atan2(ea.cross(eb).norm(), ea.dot(eb));
            VertexStar::Face face;
            face.from = uv_[a];
            face.to = uv_[b];
            set_rest(face, p, mesh_.points[a], mesh_.points[b]);
            star_.faces.push_back(face);
            const HalfEdge next = s_.twin[Mesh::previous(k)];
            if (next < 0) {
                ring_.push_back({turn, eb.norm(), uv_[b]});
                break;
            }
            k = next;
            if (k == first) {
                closed = true;
                break;
            }
        }
        if (closed && turn > 0.0)
            for (Spoke& spoke : ring_)
                spoke.angle *= 2.0 * pi / turn;
    }

    static void set_rest(VertexStar::Face& face, const Vec3& p, const Vec3& a, const Vec3& b) {
        const RestTriangle rest =
            make_rest_triangle({(a - p).norm(), (b - a).norm(), (p - b).norm()}, 0.0);
        face.area = rest.area;
        face.cot_apex = rest.cotangent[1];
        face.cot_from = rest.cotangent[2];
        face.cot_to = rest.cotangent[0];
    }

    // Where the affine map that fits the ring best takes the vertex.
    Vec2 affine_guess() const {
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        Eigen::Matrix<double, 3, 2> rhs = Eigen::Matrix<double, 3, 2>::Zero();
        Vec2 mean = Vec2::Zero();
        for (const Spoke& spoke : ring_) {
            const Vec3 row(spoke.length * std::cos(spoke.angle),
                           spoke.length * std::sin(spoke.angle), 1.0);
            normal += row * row.transpose();
            rhs += row * spoke.uv.transpose();
            mean += spoke.uv / static_cast<double>(ring_.size());
        }
        const double determinant = normal.determinant();
        const double scale = normal(0, 0) * normal(1, 1) * normal(2, 2);
        if (!(determinant > 1e-6 * scale))
            return mean;
        return (normal.inverse() * rhs).row(2).transpose();
    }

    void measure(const FlatteningProblem* rest) {
        if (rest != nullptr) {
            area_ = rest->area;
            cotangent_ = rest->cotangent;
            return;
        }
        area_.resize(s_.faces.size());
        cotangent_.resize(s_.faces.size());
        for (std::size_t f = 0; f < s_.faces.size(); ++f) {
            if (s_.alive[f] == 0)
                continue;
            std::array<double, 3> length{};
            for (std::size_t k = 0; k < 3; ++k)
                length[k] =
                    (mesh_.points[s_.faces[f][(k + 1) % 3]] - mesh_.points[s_.faces[f][k]]).norm();
            const RestTriangle triangle = make_rest_triangle(length, 0.0);
            area_[f] = triangle.area;
            cotangent_[f] = triangle.cotangent;
        }
    }

    struct Spoke {
        double angle;
        double length;
        Vec2 uv;
    };

    const Mesh& mesh_; // of the chart alone
    mesh::CoarseSurface s_;
    std::vector<Vec2> uv_;
    std::vector<HalfEdge> leaving_; // #v: one that leaves the vertex, −1 while it is removed
    std::vector<Vertex> alive_;
    std::vector<double> area_;
    std::vector<std::array<double, 3>> cotangent_;
    VertexStar star_;
    std::vector<Spoke> ring_;
};

} // namespace

std::vector<Vec2> refine_map(const Mesh& chart, mesh::CoarseSurface coarse, std::vector<Vec2> uv,
                             const FlatteningProblem& problem, bool hold_boundary,
                             const Progress& progress) {
    Refinement refinement(chart, std::move(coarse), std::move(uv));
    while (!refinement.done()) {
        refinement.refine(progress);
        refinement.relax(refinement.done() ? &problem : nullptr, hold_boundary, progress);
    }
    return refinement.take();
}

std::vector<Vec2> flatten_multilevel(
    const Mesh& mesh, const atlas::ChartSurface& surface, const FlatteningProblem& problem,
    const std::function<std::vector<Vec2>(const FlatteningProblem&, const atlas::ChartSurface&)>&
        solve,
    const Progress& progress) {
    const Mesh local = atlas::mesh_of(mesh, surface);
    mesh::CoarseMesh small = mesh::coarsen(local, multilevel_threshold / 3, progress);
    std::vector<Index> all(small.mesh.faces.size());
    std::iota(all.begin(), all.end(), 0);
    const atlas::ChartSurface disk = atlas::extract_surface(
        small.mesh, std::move(all), std::vector<std::uint8_t>(small.mesh.twin.size(), 0));
    const std::vector<Vec2> found = solve(make_flattening_problem(small.mesh, disk), disk);
    std::vector<Vec2> uv(local.points.size(), Vec2::Zero());
    for (const Vertex v : disk.all_vertices())
        uv[small.vertex[disk.vertex[v]]] = found[v];

    return refine_map(local, std::move(small.surface), std::move(uv), problem, false, progress);
}

} // namespace devseg::flatten
