#include "devseg/flatten/maps/seam_lengths.h"

#include <algorithm>
#include <cmath>

#include <Eigen/SparseCholesky>

namespace devseg::flatten {

namespace {

constexpr int most_steps = 40;
constexpr double close_enough = 1e-8; // of each edge
constexpr double shift = 1e-12;       // keeps straight polygons solvable
constexpr double least_weight = 0.02; // of edges inside: blunt triangles would turn others over

using Matrix = Eigen::SparseMatrix<double>;

// Displacements of all vertices, in balance between those of the boundary.
Eigen::MatrixX2d spread(const FlatteningProblem& problem, const Eigen::MatrixX2d& boundary) {
    std::vector<Index> unknown(at(problem.vertex_count), 0);
    for (std::size_t i = 0; i < problem.boundary.size(); ++i)
        unknown[problem.boundary[i]] = -1 - static_cast<Index>(i);
    Index count = 0;
    for (Index& u : unknown)
        if (u == 0)
            u = count++;
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixX2d rhs = Eigen::MatrixX2d::Zero(count, 2);
    const auto couple = [&](Index i, Index j, double w) {
        if (i < 0)
            return;
        entries.emplace_back(i, i, w);
        if (j < 0)
            rhs.row(i) += w * boundary.row(-1 - j);
        else
            entries.emplace_back(i, j, -w);
    };
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const Index i = unknown[problem.faces[f][k]];
            const Index j = unknown[problem.faces[f][(k + 1) % 3]];
            const double w = std::max(least_weight, problem.cotangent[f][k]);
            couple(i, j, w);
            couple(j, i, w);
        }
    Matrix matrix(count, count);
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Matrix> solver(matrix);
    const Eigen::MatrixX2d inside = count > 0 ? Eigen::MatrixX2d(solver.solve(rhs)) : rhs;
    Eigen::MatrixX2d all(problem.vertex_count, 2);
    for (Vertex v = 0; v < problem.vertex_count; ++v)
        all.row(v) = unknown[v] >= 0 ? inside.row(unknown[v]) : boundary.row(-1 - unknown[v]);
    return all;
}

} // namespace

std::optional<std::vector<Vec2>> restore_lengths(std::vector<Vec2> points,
                                                 const std::vector<double>& lengths,
                                                 const Progress& progress) {
    const auto count = static_cast<Eigen::Index>(points.size());
    const auto next = [&](Eigen::Index i) { return i + 1 < count ? i + 1 : 0; };
    const auto point = [&](Eigen::Index i) -> Vec2& { return points[static_cast<std::size_t>(i)]; };
    std::vector<Vec2> direction(points.size());
    Eigen::VectorXd excess(count);
    Eigen::SimplicialLDLT<Matrix> solver;
    for (int step = 0; step < most_steps; ++step) {
        progress.check();
        bool is_settled = true;
        for (Eigen::Index i = 0; i < count; ++i) {
            const Vec2 edge = point(next(i)) - point(i);
            const double length = lengths[static_cast<std::size_t>(i)];
            if (!(edge.norm() > 0.0))
                return std::nullopt;
            direction[static_cast<std::size_t>(i)] = edge.normalized();
            excess[i] = edge.norm() - length;
            is_settled = is_settled && std::abs(excess[i]) <= close_enough * length;
        }
        if (is_settled)
            return points;
        std::vector<Eigen::Triplet<double>> entries;
        for (Eigen::Index i = 0; i < count; ++i) {
            const double turn = -direction[static_cast<std::size_t>(i)].dot(
                direction[static_cast<std::size_t>(next(i))]);
            entries.emplace_back(i, i, 2.0 + shift);
            entries.emplace_back(i, next(i), turn);
            entries.emplace_back(next(i), i, turn);
        }
        Matrix matrix(count, count);
        matrix.setFromTriplets(entries.begin(), entries.end());
        if (step == 0)
            solver.analyzePattern(matrix);
        solver.factorize(matrix);
        const Eigen::VectorXd pull = solver.solve(excess);
        if (solver.info() != Eigen::Success || !pull.allFinite())
            return std::nullopt;
        for (Eigen::Index i = 0; i < count; ++i) {
            point(i) += pull[i] * direction[static_cast<std::size_t>(i)];
            point(next(i)) -= pull[i] * direction[static_cast<std::size_t>(i)];
        }
    }
    return std::nullopt;
}

std::optional<std::vector<Vec2>> restore_seam_lengths(const FlatteningProblem& problem,
                                                      const std::vector<Vec2>& uv,
                                                      const Progress& progress) {
    std::vector<Vec2> boundary;
    for (const Vertex v : problem.boundary)
        boundary.push_back(uv[v]);
    const auto restored = restore_lengths(boundary, problem.boundary_edge, progress);
    if (!restored)
        return std::nullopt;
    Eigen::MatrixX2d moves(static_cast<Eigen::Index>(boundary.size()), 2);
    for (std::size_t i = 0; i < boundary.size(); ++i)
        moves.row(static_cast<Eigen::Index>(i)) = ((*restored)[i] - boundary[i]).transpose();
    const Eigen::MatrixX2d all = spread(problem, moves);
    std::vector<Vec2> result = uv;
    for (std::size_t v = 0; v < result.size(); ++v)
        result[v] += all.row(static_cast<Eigen::Index>(v)).transpose();
    // Exactly, not through the rounding of a difference.
    for (std::size_t i = 0; i < boundary.size(); ++i)
        result[problem.boundary[i]] = (*restored)[i];
    return result;
}

} // namespace devseg::flatten
