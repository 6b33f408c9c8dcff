#include "devseg/flatten/energy/map_tools.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace devseg::flatten {

namespace {

// Shewchuk's bound for the orientation determinant in double precision (J. R. Shewchuk: Adaptive
// Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997, section 4.2).
constexpr double orientation_error = (3.0 + 8.0 * std::numeric_limits<double>::epsilon()) * 0.5 *
                                     std::numeric_limits<double>::epsilon();

// a · b = high + low, exactly.
void two_product(double a, double b, double& high, double& low) {
    high = a * b;
    low = std::fma(a, b, -high);
}

// a + b = high + low, exactly.
void two_sum(double a, double b, double& high, double& low) {
    high = a + b;
    const double part = high - a;
    low = (a - (high - part)) + (b - part);
}

// Adds x to an expansion: components in increasing magnitude that do not overlap.
void grow(std::vector<double>& expansion, double x) {
    std::vector<double> grown;
    for (const double component : expansion) {
        double low = 0.0;
        two_sum(x, component, x, low);
        if (low != 0.0)
            grown.push_back(low);
    }
    if (x != 0.0)
        grown.push_back(x);
    expansion.swap(grown);
}

double exact_orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
    // ax by − ay bx + bx cy − by cx + cx ay − cy ax: six products of coordinates, no differences.
    std::vector<double> sum;
    const auto add = [&](double x, double y) {
        double high = 0.0;
        double low = 0.0;
        two_product(x, y, high, low);
        grow(sum, low);
        grow(sum, high);
    };
    add(a.x(), b.y());
    add(-a.y(), b.x());
    add(b.x(), c.y());
    add(-b.y(), c.x());
    add(c.x(), a.y());
    add(-c.y(), a.x());
    return sum.empty() ? 0.0 : sum.back(); // the largest component has the sign of the sum
}

} // namespace

double orientation(const Vec2& a, const Vec2& b, const Vec2& c) {
    const double left = (a.x() - c.x()) * (b.y() - c.y());
    const double right = (a.y() - c.y()) * (b.x() - c.x());
    const double determinant = left - right;
    if (std::abs(determinant) > orientation_error * (std::abs(left) + std::abs(right)))
        return determinant;
    return exact_orientation(a, b, c);
}

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
