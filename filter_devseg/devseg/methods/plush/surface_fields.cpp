#include "devseg/methods/plush/surface_fields.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/SparseCholesky>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/rest_shape.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

flatten::RestTriangle rest_of(const Mesh& mesh, Face f) {
    return flatten::make_rest_triangle(
        {mesh.edge_length(3 * f), mesh.edge_length(3 * f + 1), mesh.edge_length(3 * f + 2)},
        tuning.tiny);
}

Eigen::VectorXd solve_shifted(Eigen::SparseMatrix<double> matrix, const Eigen::VectorXd& rhs) {
    const double amount = tuning.kernel_shift * matrix.diagonal().sum() /
                          static_cast<double>(std::max<Eigen::Index>(1, rhs.size()));
    for (Eigen::Index v = 0; v < rhs.size(); ++v)
        matrix.coeffRef(v, v) += amount;
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    Eigen::VectorXd solution = solver.solve(rhs);
    if (solver.info() != Eigen::Success || !solution.allFinite())
        throw NumericalFailure(
            "expected a solvable Laplacian of the surface, found a singular one; "
            "remesh or clean the mesh first");
    return solution;
}

} // namespace

Laplacian make_laplacian(const Mesh& mesh) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(12 * mesh.faces.size());
    for (const Face f : mesh.all_faces()) {
        const flatten::RestTriangle rest = rest_of(mesh, f);
        for (const HalfEdge h : half_edges_of(f)) {
            const Vertex i = mesh.origin(h);
            const Vertex j = mesh.target(h);
            const double w = 0.5 * rest.cotangent[corner_of(h)];
            entries.emplace_back(i, i, w);
            entries.emplace_back(j, j, w);
            entries.emplace_back(i, j, -w);
            entries.emplace_back(j, i, -w);
        }
    }
    Laplacian result{{mesh.vertex_count(), mesh.vertex_count()},
                     std::vector<double>(mesh.points.size(), 0.0)};
    result.matrix.setFromTriplets(entries.begin(), entries.end());
    for (const HalfEdge h : mesh.all_half_edges())
        result.areas[mesh.origin(h)] += mesh.face_areas[face_of(h)] / 3.0;
    return result;
}

std::vector<double> conformal_factor(const Mesh& mesh, const Laplacian& laplacian) {
    std::vector<double> defect(mesh.points.size(), 2.0 * pi);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Vec3& corner = mesh.points[mesh.origin(h)];
        const Vec3 p = mesh.points[mesh.target(h)] - corner;
        const Vec3 q = mesh.points[mesh.origin(Mesh::previous(h))] - corner;
        defect[mesh.origin(h)] -= std::atan2(p.cross(q).norm(), p.dot(q));
        if (mesh.twin[h] < 0) // each boundary vertex has one such half-edge
            defect[mesh.origin(h)] -= pi;
    }
    const double total = std::accumulate(defect.begin(), defect.end(), 0.0);
    Eigen::VectorXd rhs(mesh.vertex_count());
    for (const Vertex v : mesh.all_vertices())
        rhs[v] = total * laplacian.areas[v] / mesh.total_area - defect[v];
    const Eigen::VectorXd solution = solve_shifted(laplacian.matrix, rhs);
    std::vector<double> factor(solution.data(), solution.data() + solution.size());
    const double mean = solution.mean();
    for (double& value : factor)
        value -= mean;
    return factor;
}

std::vector<Index> find_extrema(const VertexGraph& graph, const std::vector<double>& value,
                                Index count) {
    struct Extremum {
        double prominence;
        Vertex vertex;
    };
    const auto neighbours = [&](Vertex v, auto visit) {
        for (Index i = graph.begin[v]; i < graph.begin[at(v) + 1]; ++i)
            visit(graph.vertex[i]);
    };
    std::vector<Extremum> found;
    for (Vertex v = 0; v < static_cast<Index>(value.size()); ++v) {
        bool lowest = graph.begin[v] < graph.begin[at(v) + 1];
        bool highest = lowest;
        neighbours(v, [&](Index u) {
            neighbours(u, [&](Index w) {
                if (w == v || !(lowest || highest))
                    return;
                const double difference = value[w] - value[v];
                lowest = lowest && (difference > 0.0 || (difference == 0.0 && w > v));
                highest = highest && (difference < 0.0 || (difference == 0.0 && w > v));
            });
        });
        if (lowest || highest)
            found.push_back({std::abs(value[v]), v});
    }
    std::stable_sort(found.begin(), found.end(), [](const Extremum& a, const Extremum& b) {
        return a.prominence > b.prominence;
    });
    std::vector<Index> extrema;
    for (const Extremum& e : found)
        if (static_cast<Index>(extrema.size()) < count)
            extrema.push_back(e.vertex);
    return extrema;
}

std::vector<double> mean_curvature(const Mesh& mesh, const Laplacian& laplacian) {
    Eigen::VectorXd integral = Eigen::VectorXd::Zero(mesh.vertex_count());
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge twin = mesh.twin[h];
        if (twin < 0)
            continue;
        const Vec3& n = mesh.face_normals[face_of(h)];
        const Vec3& m = mesh.face_normals[face_of(twin)];
        const Vec3 edge = mesh.points[mesh.target(h)] - mesh.points[mesh.origin(h)];
        const double angle = std::atan2(n.cross(m).dot(edge.normalized()), n.dot(m));
        // A quarter of length times angle to each end, once from each side.
        integral[mesh.origin(h)] += 0.25 * edge.norm() * angle;
        integral[mesh.target(h)] += 0.25 * edge.norm() * angle;
    }
    integral *= 0.5;
    Eigen::SparseMatrix<double> matrix = laplacian.matrix;
    const double radius = tuning.curvature_radius * mean_edge_length(mesh);
    matrix *= radius * radius;
    for (const Vertex v : mesh.all_vertices())
        matrix.coeffRef(v, v) += laplacian.areas[v];
    const Eigen::VectorXd smooth = solve_shifted(matrix, integral);
    const double sphere = std::sqrt(mesh.total_area / (4.0 * pi));
    std::vector<double> curvature(mesh.points.size());
    for (std::size_t v = 0; v < curvature.size(); ++v)
        curvature[v] = sphere * smooth[static_cast<Eigen::Index>(v)];
    return curvature;
}

BoneWeights bone_weights(const Mesh& mesh, const Laplacian& laplacian, const Skeleton& skeleton,
                         const Progress& progress) {
    Eigen::SparseMatrix<double> matrix = laplacian.matrix;
    std::vector<Index> nearest(mesh.points.size(), 0);
    std::vector<double> heat(mesh.points.size());
    const double floor = 1e-6 * mesh.total_area;
    for (const Vertex v : mesh.all_vertices()) {
        double least = infinite;
        for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
            const auto& [i, j] = skeleton.bones[b];
            const double d =
                squared_distance(mesh.points[v], skeleton.joints[i], skeleton.joints[j]);
            if (d < least) {
                least = d;
                nearest[v] = static_cast<Index>(b);
            }
        }
        heat[v] = tuning.conductance * std::max(laplacian.areas[v], 1e-12 * mesh.total_area) /
                  std::max(least, floor);
        matrix.coeffRef(v, v) += heat[v];
    }
    progress.check();
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    BoneWeights weights(mesh.points.size());
    if (solver.info() != Eigen::Success)
        throw NumericalFailure("expected a solvable heat equation on the surface, found a singular "
                               "one; remesh or clean the mesh first");
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
        progress.check();
        Eigen::VectorXd source = Eigen::VectorXd::Zero(mesh.vertex_count());
        for (const Vertex v : mesh.all_vertices())
            if (nearest[v] == static_cast<Index>(b))
                source[v] = heat[v];
        const Eigen::VectorXd share = solver.solve(source);
        for (const Vertex v : mesh.all_vertices())
            if (share[v] > tuning.least_bone)
                weights[v].emplace_back(static_cast<Index>(b), share[v]);
    }
    for (auto& row : weights) {
        std::stable_sort(row.begin(), row.end(),
                         [](const auto& a, const auto& b) { return a.second > b.second; });
        row.resize(std::min(row.size(), tuning.bones_at_vertex));
        double sum = 0.0;
        for (const auto& entry : row)
            sum += entry.second;
        for (auto& entry : row)
            entry.second /= sum;
    }
    return weights;
}

SkeletonDirection skeleton_direction(const Skeleton& skeleton, const BoneWeights& weights, Index a,
                                     Index b, const Vec3& normal) {
    const Vec3 u = normal.unitOrthogonal();
    const Vec3 v = normal.cross(u);
    double uu = 0.0;
    double uv = 0.0;
    double vv = 0.0;
    for (const Vertex vertex : {a, b})
        for (const auto& [bone, weight] : weights[vertex]) {
            const auto& [i, j] = skeleton.bones[bone];
            const Vec3 along = (skeleton.joints[j] - skeleton.joints[i]).normalized();
            uu += 0.5 * weight * along.dot(u) * along.dot(u);
            uv += 0.5 * weight * along.dot(u) * along.dot(v);
            vv += 0.5 * weight * along.dot(v) * along.dot(v);
        }
    SkeletonDirection result;
    const double difference = std::hypot(uu - vv, 2.0 * uv);
    if (!(difference > 0.0))
        return result;
    const double angle = 0.5 * std::atan2(2.0 * uv, uu - vv);
    result.direction = std::cos(angle) * u + std::sin(angle) * v;
    const double lies = std::clamp((uu + vv) / tuning.lying, 0.0, 1.0);
    result.agreement = lies * difference / (uu + vv);
    return result;
}

} // namespace devseg::plush
