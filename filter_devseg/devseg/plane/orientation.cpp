// The sign of a determinant, exactly.
//
// References
//   J. R. Shewchuk: Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
//   Predicates. Discrete & Computational Geometry 18(3), 1997, doi:10.1007/PL00009321
#include <cmath>
#include <limits>

#include "devseg/plane/plane.h"

namespace devseg::plane {

namespace {

// Shewchuk's bound for the determinant in double precision (section 4.2).
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

} // namespace devseg::plane
