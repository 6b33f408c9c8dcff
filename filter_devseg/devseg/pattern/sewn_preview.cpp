#include "devseg/pattern/sewn_preview.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>

#include "devseg/base/errors.h"
#include "devseg/mesh/surface_search.h"

namespace devseg::pattern {

namespace {

constexpr double smoothing = 0.015; // of the diagonal: details below it are forgotten at the start
constexpr double inertia = 0.02;    // of a spring's stiffness: steps stay small
constexpr double at_rest = 2e-5;    // of the diagonal: the mean step at which the cloth is at rest
constexpr double burst =
    10.0; // of the diagonal: mean step of a net that does not hold the pressure
// Stiffness of a net of springs of stiffness 1 along the edges of even triangles, per length.
constexpr double net_stiffness = 1.1547;

using Solver = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>;
using Points = Eigen::MatrixX3d;

struct Spring {
    Index a;
    Index b;
    double length;
};

std::vector<Spring> make_springs(const Mesh& mesh, const CornerUv& uv, double scale) {
    std::vector<Spring> springs;
    const auto flat = [&](HalfEdge h) { return scale * (uv[Mesh::next(h)] - uv[h]).norm(); };
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge twin = mesh.twin[h];
        if (twin < h) // also where there is none
            springs.push_back({mesh.origin(h), mesh.target(h),
                               twin < 0 ? flat(h) : 0.5 * (flat(h) + flat(twin))});
    }
    return springs;
}

Eigen::SparseMatrix<double> spring_matrix(Index count, const std::vector<Spring>& springs,
                                          double weight, double diagonal) {
    std::vector<Eigen::Triplet<double>> entries;
    for (const Spring& s : springs) {
        entries.emplace_back(s.a, s.a, weight);
        entries.emplace_back(s.b, s.b, weight);
        entries.emplace_back(s.a, s.b, -weight);
        entries.emplace_back(s.b, s.a, -weight);
    }
    for (Vertex v = 0; v < count; ++v)
        entries.emplace_back(v, v, diagonal);
    Eigen::SparseMatrix<double> matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
}

Points factor_and_solve(const Eigen::SparseMatrix<double>& matrix, const Points& rhs) {
    const Solver solver(matrix);
    if (solver.info() != Eigen::Success)
        throw NumericalFailure("expected springs that can be solved, found a singular system; "
                               "remesh or clean the mesh first");
    return solver.solve(rhs);
}

// Σ of the pressure on the faces, a third of each to its corners.
Points pressure_on(const Mesh& mesh, const Points& x, double pressure) {
    Points force = Points::Zero(x.rows(), 3);
    for (const Triangle& t : mesh.faces) {
        const Eigen::RowVector3d p = x.row(t[1]) - x.row(t[0]);
        const Eigen::RowVector3d q = x.row(t[2]) - x.row(t[0]);
        const Eigen::RowVector3d share = pressure / 6.0 * p.cross(q);
        for (const Vertex v : t)
            force.row(v) += share;
    }
    return force;
}

// Moves and turns x onto the surface, vertex to vertex.
void align(const Mesh& mesh, Points& x) {
    Eigen::Matrix3Xd to(3, x.rows());
    for (const Vertex v : mesh.all_vertices())
        to.col(v) = mesh.points[v];
    const Eigen::Matrix4d motion = Eigen::umeyama(Eigen::Matrix3Xd(x.transpose()), to, false);
    const Eigen::Matrix3d turn = motion.topLeftCorner<3, 3>();
    const Eigen::RowVector3d shift = motion.topRightCorner<3, 1>().transpose();
    x = (x * turn.transpose()).rowwise() + shift;
}

void measure(const Mesh& mesh, double diagonal, SewnPreview& result) {
    const mesh::SurfaceSearch search(mesh);
    result.distance.assign(mesh.points.size(), 0.0);
    const std::vector<Vec3> normals = mesh::vertex_normals(mesh);
    for (const Vertex v : mesh.all_vertices()) {
        if (search.leaving(v) < 0)
            continue;
        const Vec3& p = result.points[v];
        const auto any = [](Index) { return true; };
        const Index near = search.vertex(p, normals[v], any);
        if (near >= 0)
            result.distance[v] = (search.on_faces(p, near, any).second - p).norm();
        result.largest_distance = std::max(result.largest_distance, result.distance[v]);
    }
    for (const HalfEdge h : mesh.all_half_edges())
        result.mean_distance += mesh.face_areas[h / 3] / 3.0 * result.distance[mesh.origin(h)];
    result.mean_distance /= mesh.total_area * diagonal;
    result.largest_distance /= diagonal;
}

} // namespace

SewnPreview sew_and_inflate(const Mesh& mesh, const CornerUv& uv, const SewnOptions& options,
                            Progress& progress) {
    check_ranges(options);
    const atlas::EvenLayout even = atlas::even_layout(mesh, atlas::charts_from_uv(mesh, uv), uv);
    if (!(even.scale > 0.0))
        throw InvalidMesh("expected texture coordinates with an area, found none; run "
                          "'Charts: Flatten' again");
    Points x(mesh.vertex_count(), 3);
    for (const Vertex v : mesh.all_vertices())
        x.row(v) = mesh.points[v].transpose();
    const double diagonal = mesh.diagonal();
    const std::vector<Spring> springs = make_springs(mesh, even.uv, even.scale);
    const double edge = std::sqrt(mesh.total_area / std::max<Index>(1, mesh.face_count()));
    const double blur = std::pow(smoothing * diagonal / edge, 2.0);
    x = factor_and_solve(spring_matrix(mesh.vertex_count(), springs, blur, 1.0), x);

    // In a sphere of the surface's size the pressure stretches the net by `stuffing`.
    const double radius = std::sqrt(mesh.total_area / (4.0 * pi));
    const Solver solver(spring_matrix(mesh.vertex_count(), springs, 1.0, inertia));
    if (solver.info() != Eigen::Success)
        throw NumericalFailure("expected springs that can be solved, found a singular system; "
                               "remesh or clean the mesh first");
    const Points start = x;
    SewnPreview result;
    result.stuffing = options.stuffing;
    for (int round = 0; round < options.max_iterations && !result.converged; ++round) {
        progress.update(static_cast<double>(round) / options.max_iterations);
        ++result.rounds;
        const double pressure = 2.0 * result.stuffing * net_stiffness / radius;
        Points rhs = inertia * x + pressure_on(mesh, x, pressure);
        for (const Spring& s : springs) {
            const Eigen::RowVector3d along = x.row(s.a) - x.row(s.b);
            const double length = along.norm();
            if (!(length > 0.0))
                continue;
            rhs.row(s.a) += s.length / length * along;
            rhs.row(s.b) -= s.length / length * along;
        }
        const Points next = solver.solve(rhs);
        const double step = (next - x).rowwise().norm().mean();
        if (step < burst * diagonal) {
            result.converged = step < at_rest * diagonal;
            x = next;
        } else {
            result.stuffing *= 0.5;
            x = start;
        }
    }
    if (!x.allFinite())
        throw NumericalFailure("expected springs that can be solved, found a singular system; "
                               "remesh or clean the mesh first");
    align(mesh, x);
    result.points.resize(mesh.points.size());
    for (const Vertex v : mesh.all_vertices())
        result.points[v] = x.row(v).transpose();
    measure(mesh, diagonal, result);
    return result;
}

} // namespace devseg::pattern
