#include "devseg/flatten/energy/map_tools.h"

#include <algorithm>
#include <cmath>

#include "devseg/plane/plane.h"

namespace devseg::flatten {

void expect_no_holes(const FlatteningProblem& problem) {
    if (!problem.holes.empty())
        throw NumericalFailure("expected a chart without holes, found one with " +
                               std::to_string(problem.holes.size()));
}

bool is_positive(const std::vector<Triangle>& faces, const std::vector<Vec2>& uv, Face f) {
    const Triangle& t = faces[f];
    return orientation(uv[t[0]], uv[t[1]], uv[t[2]]) > 0.0;
}

bool is_positive_around(const std::vector<Triangle>& faces, const std::vector<HalfEdge>& twin,
                        const std::vector<Vec2>& uv, HalfEdge leaving) {
    bool positive = true;
    mesh::visit_star(twin, leaving, [&](HalfEdge h) {
        positive = positive && is_positive(faces, uv, face_of(h));
    });
    return positive;
}

Index count_flips(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    Index flips = 0;
    for (Face f = 0; f < static_cast<Index>(problem.faces.size()); ++f)
        flips += is_positive(problem.faces, uv, f) ? 0 : 1;
    return flips;
}

double map_area(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double twice = 0.0;
    for (const Triangle& t : problem.faces)
        twice += plane::cross(uv[t[1]] - uv[t[0]], uv[t[2]] - uv[t[0]]);
    return 0.5 * twice;
}

double face_stretch(const FlatteningProblem& problem, const std::vector<Vec2>& uv, std::size_t f) {
    const Eigen::Matrix2d j = jacobian(problem, uv, f);
    // Of the inverse map: Γ² + γ² = |J|² / det², Γ γ = 1 / det.
    const double det = j.determinant();
    const double sum = j.squaredNorm() / (det * det);
    return std::sqrt(0.5 * (sum + std::sqrt(std::max(0.0, sum * sum - 4.0 / (det * det)))));
}

std::vector<double> face_stretches(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    std::vector<double> stretches(problem.faces.size());
    for (std::size_t f = 0; f < stretches.size(); ++f)
        stretches[f] = face_stretch(problem, uv, f);
    return stretches;
}

double largest_stretch(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double largest = 1.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        largest = std::max(largest, face_stretch(problem, uv, f));
    return largest;
}

double squared_l2_stretch(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double sum = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Eigen::Matrix2d j = jacobian(problem, uv, f);
        const double det = j.determinant();
        sum += 0.5 * j.squaredNorm() / (det * det) * problem.area[f] / problem.total_area;
    }
    return sum;
}

double l2_stretch(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    return least_area_ratio(problem, uv) > 0.0 ? std::sqrt(squared_l2_stretch(problem, uv))
                                               : infinite;
}

double least_area_ratio(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double least = infinite;
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        least = std::min(least, jacobian(problem, uv, f).determinant());
    return least;
}

void scale_to_area(const FlatteningProblem& problem, std::vector<Vec2>& uv) {
    const double area = map_area(problem, uv);
    const double scale = area > 0.0 ? std::sqrt(problem.total_area / area) : 1.0;
    Vec2 centre = Vec2::Zero();
    for (const Vec2& p : uv)
        centre += p;
    centre /= static_cast<double>(uv.size());
    for (Vec2& p : uv)
        p = scale * (p - centre);
}

} // namespace devseg::flatten
