#include "devseg/flatten/energy/vertex_relaxation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "devseg/plane/plane.h"

namespace devseg::flatten {

namespace {

constexpr int line_search_steps = 8;
constexpr double least_curvature = 1e-2; // of the larger eigenvalue of the Hessian: keeps it convex

// |J|² of a face: its Dirichlet energy by the cotangent formula.
double squared_norm(const VertexStar::Face& f, const Vec2& p) {
    return (f.cot_from * (p - f.to).squaredNorm() + f.cot_to * (p - f.from).squaredNorm() +
            f.cot_apex * (f.from - f.to).squaredNorm()) /
           (2.0 * f.area);
}

} // namespace

// With d = det J, |J⁻¹|² = |J|² / d²; along p, |J|² is quadratic and d is linear.
double VertexStar::energy(const Vec2& p) const {
    double sum = 0.0;
    for (const Face& f : faces) {
        const double d = plane::cross(f.from - p, f.to - p) / (2.0 * f.area);
        if (!(d > 0.0))
            return infinite;
        const double inverse = 1.0 / d; // as in relax_vertex, to the last bit
        const double density = 0.25 * squared_norm(f, p) * (1.0 + inverse * inverse);
        sum += f.area * (steepness > 0.0 ? std::exp(steepness * (density - 1.0)) : density);
    }
    return sum;
}

void gather_star(const StarSource& source, const std::vector<Vec2>& uv, HalfEdge leaving,
                 VertexStar& star) {
    star.faces.clear();
    mesh::visit_star(source.twin, leaving, [&](Index k) {
        const std::size_t f = at(k / 3);
        const std::size_t e = at(k % 3);
        VertexStar::Face face;
        face.from = uv[source.faces[f][(e + 1) % 3]];
        face.to = uv[source.faces[f][(e + 2) % 3]];
        face.area = source.area[f];
        face.cot_apex = source.cotangent[f][(e + 1) % 3];
        face.cot_from = source.cotangent[f][(e + 2) % 3];
        face.cot_to = source.cotangent[f][e];
        star.faces.push_back(face);
    });
}

Vec2 relax_vertex(const VertexStar& star, const Vec2& start) {
    Vec2 gradient = Vec2::Zero();
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    double energy = 0.0;
    for (const VertexStar::Face& f : star.faces) {
        const double d = plane::cross(f.from - start, f.to - start) / (2.0 * f.area);
        if (!(d > 0.0))
            return start; // rounding left no room: nothing can be gained here
        const double q = squared_norm(f, start);
        const Vec2 dq = (f.cot_from * (start - f.to) + f.cot_to * (start - f.from)) / f.area;
        const Vec2 dd = Vec2(f.from.y() - f.to.y(), f.to.x() - f.from.x()) / (2.0 * f.area);
        const double inverse = 1.0 / d;
        const double inverse2 = inverse * inverse;
        const double density = 0.25 * q * (1.0 + inverse2);
        const Vec2 slope = 0.25 * (1.0 + inverse2) * dq - 0.5 * q * inverse2 * inverse * dd;
        const double value =
            f.area * (star.steepness > 0.0 ? std::exp(star.steepness * (density - 1.0)) : density);
        // Of exp(s (ψ − 1)): s e^… ∇ψ, and s e^… (∇²ψ + s ∇ψ ∇ψᵀ).
        const double w = star.steepness > 0.0 ? star.steepness * value : f.area;
        const double mixed = -0.5 * inverse2 * inverse * w;
        const double square = 1.5 * q * inverse2 * inverse2 * w;
        const double even = 0.25 * (f.cot_from + f.cot_to) / f.area * (1.0 + inverse2) * w;
        const double outer = star.steepness * w;
        energy += value;
        gradient += w * slope;
        xx += even + 2.0 * mixed * dq.x() * dd.x() + square * dd.x() * dd.x() +
              outer * slope.x() * slope.x();
        yy += even + 2.0 * mixed * dq.y() * dd.y() + square * dd.y() * dd.y() +
              outer * slope.y() * slope.y();
        xy += mixed * (dq.x() * dd.y() + dq.y() * dd.x()) + square * dd.x() * dd.y() +
              outer * slope.x() * slope.y();
    }
    const double mean = 0.5 * (xx + yy);
    const double radius = std::hypot(0.5 * (xx - yy), xy);
    const double floor = least_curvature * (std::abs(mean) + radius);
    const double shift = std::max(0.0, floor - (mean - radius));
    xx += shift;
    yy += shift;
    const double det = xx * yy - xy * xy;
    if (!(det > 0.0))
        return start;
    const Vec2 step(-(yy * gradient.x() - xy * gradient.y()) / det,
                    -(xx * gradient.y() - xy * gradient.x()) / det);
    double t = 1.0;
    for (int i = 0; i < line_search_steps; ++i, t *= 0.5) {
        const Vec2 p = start + t * step;
        if (star.energy(p) < energy)
            return p;
    }
    return start;
}

Vec2 kernel_point(const VertexStar& star, const Vec2& hint) {
    Eigen::AlignedBox2d box(hint);
    for (const VertexStar::Face& f : star.faces) {
        box.extend(f.from);
        box.extend(f.to);
    }
    std::vector<Vec2> polygon{
        box.corner(Eigen::AlignedBox2d::BottomLeft), box.corner(Eigen::AlignedBox2d::BottomRight),
        box.corner(Eigen::AlignedBox2d::TopRight), box.corner(Eigen::AlignedBox2d::TopLeft)};
    std::vector<Vec2> clipped;
    for (const VertexStar::Face& f : star.faces) {
        clipped.clear();
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Vec2& a = polygon[i];
            const Vec2& b = polygon[(i + 1) % polygon.size()];
            const double side_a = plane::cross(f.from - a, f.to - a);
            const double side_b = plane::cross(f.from - b, f.to - b);
            if (side_a >= 0.0)
                clipped.push_back(a);
            if ((side_a > 0.0 && side_b < 0.0) || (side_a < 0.0 && side_b > 0.0))
                clipped.push_back(a + (side_a / (side_a - side_b)) * (b - a));
        }
        polygon.swap(clipped);
    }
    if (polygon.empty())
        return hint;
    double area = 0.0;
    Vec2 centre = Vec2::Zero();
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const double a = plane::cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
        area += a;
        centre += a / 3.0 * (polygon[0] + polygon[i] + polygon[i + 1]);
    }
    return area > 0.0 ? Vec2(centre / area) : polygon.front();
}

} // namespace devseg::flatten
