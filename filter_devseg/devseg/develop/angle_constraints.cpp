#include "devseg/develop/angle_constraints.h"

#include <algorithm>

#include "devseg/mesh/angle_defects.h"

namespace devseg::develop {

AngleConstraints::AngleConstraints(const Mesh& mesh, const std::vector<Index>& vertices,
                                   const std::vector<Index>& point_of) {
    const std::vector<Index> leaving = mesh::leaving_half_edges(mesh);
    begin_.push_back(0);
    for (const Vertex v : vertices) {
        point_.push_back(point_of[v]);
        mesh::visit_star(mesh, leaving[v],
                         [&](HalfEdge h) { point_.push_back(point_of[mesh.target(h)]); });
        begin_.push_back(static_cast<Index>(point_.size()));
    }
    gradient_.assign(point_.size(), Vec3::Zero());
    Index points = 0;
    for (const Index p : point_of)
        points = std::max(points, p + 1);
    build_pattern(points);
}

void AngleConstraints::build_pattern(Index points) {
    row_of_.resize(point_.size());
    uses_begin_.assign(at(points) + 1, 0);
    for (Index r = 0; r < count(); ++r)
        for (Index e = begin_[r]; e < begin_[at(r) + 1]; ++e) {
            row_of_[e] = r;
            ++uses_begin_[at(point_[e]) + 1];
        }
    for (std::size_t p = 0; p < at(points); ++p)
        uses_begin_[p + 1] += uses_begin_[p];
    uses_.resize(point_.size());
    std::vector<Index> next(uses_begin_.begin(), uses_begin_.end() - 1);
    for (std::size_t e = 0; e < point_.size(); ++e)
        uses_[next[point_[e]]++] = static_cast<Index>(e);

    std::vector<Eigen::Triplet<double, Index>> entries;
    const auto for_each_pair = [&](auto visit) {
        for (Index p = 0; p < points; ++p)
            for (Index i = uses_begin_[p]; i < uses_begin_[at(p) + 1]; ++i)
                for (Index j = uses_begin_[p]; j < uses_begin_[at(p) + 1]; ++j) {
                    const Index row = row_of_[uses_[i]];
                    const Index column = row_of_[uses_[j]];
                    if (row >= column)
                        visit(row, column);
                }
    };
    for_each_pair([&](Index row, Index column) { entries.emplace_back(row, column, 0.0); });
    normal_.resize(count(), count());
    normal_.setFromTriplets(entries.begin(), entries.end());
    normal_.makeCompressed();
    const auto slot_of = [&](Index row, Index column) {
        const Index* first = normal_.innerIndexPtr() + normal_.outerIndexPtr()[column];
        const Index* last = normal_.innerIndexPtr() + normal_.outerIndexPtr()[column + 1];
        return static_cast<Index>(std::lower_bound(first, last, row) - normal_.innerIndexPtr());
    };
    slot_.reserve(entries.size());
    for_each_pair([&](Index row, Index column) { slot_.push_back(slot_of(row, column)); });
    for (Index r = 0; r < count(); ++r)
        diagonal_.push_back(slot_of(r, r));
}

double AngleConstraints::defect(Index r, const std::vector<Vec3>& points) const {
    const Index first = begin_[r] + 1;
    const Index last = begin_[at(r) + 1];
    const Vec3& centre = points[point_[first - 1]];
    double value = 2.0 * pi;
    for (Index e = first; e < last; ++e)
        value -= mesh::corner_angle(centre, points[point_[e]],
                                    points[point_[e + 1 < last ? e + 1 : first]]);
    return value;
}

Eigen::VectorXd AngleConstraints::defects(const std::vector<Vec3>& points) const {
    Eigen::VectorXd value(count());
    for (Index r = 0; r < count(); ++r)
        value[r] = defect(r, points);
    return value;
}

void AngleConstraints::update_defects(const std::vector<Vec3>& points,
                                      const std::vector<std::uint8_t>& changed,
                                      Eigen::VectorXd& defects) const {
    for (Index r = 0; r < count(); ++r)
        if (std::any_of(first_point(r), last_point(r), [&](Index p) { return changed[p] != 0; }))
            defects[r] = defect(r, points);
}

void AngleConstraints::linearise(const std::vector<Vec3>& points) {
    std::fill(gradient_.begin(), gradient_.end(), Vec3::Zero());
    for (Index r = 0; r < count(); ++r) {
        const Index first = begin_[r] + 1;
        const Index last = begin_[at(r) + 1];
        const Vec3& centre = points[point_[first - 1]];
        for (Index e = first; e < last; ++e) {
            const Index other = e + 1 < last ? e + 1 : first;
            const Vec3 a = points[point_[e]] - centre;
            const Vec3 b = points[point_[other]] - centre;
            const Vec3 n = a.cross(b).normalized();
            const Vec3 at_a = -n.cross(a) / a.squaredNorm();
            const Vec3 at_b = n.cross(b) / b.squaredNorm();
            gradient_[e] += at_a;
            gradient_[other] += at_b;
            gradient_[first - 1] -= at_a + at_b;
        }
    }
}

const Normal& AngleConstraints::normal_matrix(const std::vector<double>& mobility,
                                              const Eigen::VectorXd& diagonal) {
    double* value = normal_.valuePtr();
    std::fill(value, value + normal_.nonZeros(), 0.0);
    std::size_t pair = 0;
    for (std::size_t p = 0; p + 1 < uses_begin_.size(); ++p)
        for (Index i = uses_begin_[p]; i < uses_begin_[p + 1]; ++i)
            for (Index j = uses_begin_[p]; j < uses_begin_[p + 1]; ++j) {
                const Index a = uses_[i];
                const Index b = uses_[j];
                if (row_of_[a] >= row_of_[b])
                    value[slot_[pair++]] += mobility[p] * gradient_[a].dot(gradient_[b]);
            }
    for (Index r = 0; r < count(); ++r)
        value[diagonal_[r]] += diagonal[r];
    return normal_;
}

std::vector<Vec3> AngleConstraints::displacement(const std::vector<double>& mobility,
                                                 const Eigen::VectorXd& lambda) const {
    std::vector<Vec3> result(uses_begin_.size() - 1, Vec3::Zero());
    for (std::size_t p = 0; p < result.size(); ++p)
        for (Index i = uses_begin_[p]; i < uses_begin_[p + 1]; ++i)
            result[p] += mobility[p] * lambda[row_of_[uses_[i]]] * gradient_[uses_[i]];
    return result;
}

} // namespace devseg::develop
