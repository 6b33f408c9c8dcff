#include "devseg/flatten/energy/map_tools.h"

#include <algorithm>
#include <cmath>

namespace devseg::flatten {

Index count_flips(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    Index flips = 0;
    for (const Triangle& t : problem.faces)
        flips += orientation(uv[t[0]], uv[t[1]], uv[t[2]]) > 0.0 ? 0 : 1;
    return flips;
}

double map_area(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double twice = 0.0;
    for (const Triangle& t : problem.faces) {
        const Vec2 p = uv[t[1]] - uv[t[0]];
        const Vec2 q = uv[t[2]] - uv[t[0]];
        twice += p.x() * q.y() - p.y() * q.x();
    }
    return 0.5 * twice;
}

double face_stretch(const FlatteningProblem& problem, const std::vector<Vec2>& uv, std::size_t f) {
    const Eigen::Matrix2d j = jacobian(problem, uv, f);
    // Of the inverse map: Γ² + γ² = |J|² / det², Γ γ = 1 / det.
    const double det = j.determinant();
    const double sum = j.squaredNorm() / (det * det);
    return std::sqrt(0.5 * (sum + std::sqrt(std::max(0.0, sum * sum - 4.0 / (det * det)))));
}

double l2_stretch(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double sum = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Eigen::Matrix2d j = jacobian(problem, uv, f);
        const double det = j.determinant();
        if (!(det > 0.0))
            return infinite;
        sum += 0.5 * problem.area[f] * j.squaredNorm() / (det * det);
    }
    return std::sqrt(sum / problem.total_area);
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
