#include "devseg/flatten/energy/harmonic.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

// Vertices at mean-value weights at most. On the charts of 22 models, all that this mended had
// fewer; on the others, the boundary is at fault.
constexpr Index most_mended = 32;

} // namespace

// Of the symmetric system only the lower half is stored.
HarmonicMap::HarmonicMap(const FlatteningProblem& problem, std::vector<Vec2>& uv,
                         const Weight& weight)
    : problem_(problem), slot_(uv.size(), 0) {
    for (const Vertex v : problem.boundary)
        slot_[v] = -1;
    for (const std::vector<Index>& hole : problem.holes)
        for (const Vertex v : hole)
            slot_[v] = -1;
    for (Index& s : slot_)
        if (s >= 0)
            s = unknowns_++;
    if (unknowns_ == 0)
        return;
    Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(unknowns_);
    Eigen::MatrixX2d rhs = Eigen::MatrixX2d::Zero(unknowns_, 2);
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(3 * problem.faces.size() + at(unknowns_));
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const double w = weight(problem.cotangent[f][k]);
            const Vertex v = problem.faces[f][k];
            const Vertex u = problem.faces[f][(k + 1) % 3];
            const Index i = slot_[v];
            const Index j = slot_[u];
            for (const Index own : {i, j})
                if (own >= 0)
                    diagonal[own] += w;
            if (i >= 0 && j >= 0)
                entries.emplace_back(std::max(i, j), std::min(i, j), -w);
            else if (i >= 0 || j >= 0)
                rhs.row(std::max(i, j)) += w * uv[i >= 0 ? u : v].transpose();
        }
    for (Index i = 0; i < unknowns_; ++i)
        entries.emplace_back(i, i, diagonal[i]);
    Eigen::SparseMatrix<double> matrix(unknowns_, unknowns_);
    matrix.setFromTriplets(entries.begin(), entries.end());
    solver_.compute(matrix);
    if (solver_.info() == Eigen::Success)
        rhs = Eigen::MatrixX2d(solver_.solve(rhs));
    if (solver_.info() != Eigen::Success || !rhs.allFinite())
        throw NumericalFailure("expected solvable equations for the inside of a chart, found a "
                               "singular system; repair faces without area first");
    for (std::size_t v = 0; v < uv.size(); ++v)
        if (slot_[v] >= 0)
            uv[v] = rhs.row(slot_[v]).transpose();
}

// Rows S of the system A x = b become M x = r. With Z the columns S of A⁻¹, x + Z c meets all other
// rows for every c, and the new ones for (M Z) c = r − M x.
Index HarmonicMap::mend(std::vector<Vec2>& uv) const {
    std::vector<Index> row(slot_.size(), -1); // #v
    Index count = 0;
    for (const Triangle& t : problem_.faces)
        if (!(orientation(uv[t[0]], uv[t[1]], uv[t[2]]) > 0.0))
            for (const Vertex v : t)
                if (slot_[v] >= 0 && row[v] < 0)
                    row[v] = count++;
    if (count == 0 || count > most_mended)
        return 0;
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(unknowns_, count); // Z
    for (std::size_t v = 0; v < row.size(); ++v)
        if (row[v] >= 0)
            columns(slot_[v], row[v]) = 1.0;
    columns = Eigen::MatrixXd(solver_.solve(columns));
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(count, count); // M Z
    Eigen::MatrixX2d missing = Eigen::MatrixX2d::Zero(count, 2);  // r − M x
    for (Face f = 0; f < static_cast<Index>(problem_.faces.size()); ++f)
        for (Index k = 0; k < 3; ++k) {
            const Vertex v = problem_.faces[f][k];
            if (row[v] < 0)
                continue;
            const double half = std::tan(0.5 * std::atan2(1.0, problem_.cotangent[f][(k + 1) % 3]));
            for (const Index other : {(k + 1) % 3, (k + 2) % 3}) {
                const Vertex u = problem_.faces[f][other];
                const double w = half / (problem_.corner(f, other) - problem_.corner(f, k)).norm();
                missing.row(row[v]) += w * (uv[u] - uv[v]).transpose();
                system.row(row[v]) += w * columns.row(slot_[v]);
                if (slot_[u] >= 0)
                    system.row(row[v]) -= w * columns.row(slot_[u]);
            }
        }
    const Eigen::MatrixX2d change = columns * system.partialPivLu().solve(missing);
    for (std::size_t v = 0; v < uv.size(); ++v)
        if (slot_[v] >= 0)
            uv[v] += change.row(slot_[v]).transpose();
    return change.allFinite() ? count : 0;
}

} // namespace devseg::flatten
