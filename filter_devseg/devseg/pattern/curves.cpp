#include "devseg/pattern/curves.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <Eigen/LU>

#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// Every edge is sampled at so many places at least, and long edges more often.
constexpr int least_samples = 4;
// Samples of a stretch between two joints: enough to see every bend of a cubic.
constexpr double usual_samples = 48.0;
// Rounds in which the parameters of the samples are improved.
constexpr int fit_rounds = 4;
// A curve's handles are at most so long, as a share of the stretch: longer ones make loops.
constexpr double longest_handle = 1.5;

// A curve is as long as what it stands for, up to this share: seams must not change. Lines that
// leave out a little raggedness may be shorter by more.
constexpr double length_share = 1e-6;
constexpr double line_share = 1e-4;
constexpr int length_steps = 12;

using Control = std::array<Vec2, 4>;

Vec2 evaluate(const Control& c, double t) {
    const double s = 1.0 - t;
    return s * s * s * c[0] + 3.0 * s * s * t * c[1] + 3.0 * s * t * t * c[2] + t * t * t * c[3];
}

Vec2 derivative(const Control& c, double t) {
    const double s = 1.0 - t;
    return 3.0 * (s * s * (c[1] - c[0]) + 2.0 * s * t * (c[2] - c[1]) + t * t * (c[3] - c[2]));
}

Vec2 second_derivative(const Control& c, double t) {
    return 6.0 * ((1.0 - t) * (c[2] - 2.0 * c[1] + c[0]) + t * (c[3] - 2.0 * c[2] + c[1]));
}

// Gauss-Legendre rule with five points, on eight parts of the curve.
double length_of(const Control& c) {
    constexpr int parts = 8;
    constexpr double nodes[] = {0.0, 0.5384693101056831, 0.9061798459386640};
    constexpr double weights[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
    double length = 0.0;
    for (int part = 0; part < parts; ++part)
        for (int i = -2; i <= 2; ++i) {
            const double node = i < 0 ? -nodes[-i] : nodes[i];
            const double t = (part + 0.5 + 0.5 * node) / parts;
            length += weights[std::abs(i)] * derivative(c, t).norm() / (2.0 * parts);
        }
    return length;
}

// Makes both handles longer or shorter by one factor until the curve has the length (secant steps).
bool match_length(double length, Control& curve) {
    const Control start = curve;
    const auto scaled = [&](double factor) {
        Control c = start;
        c[1] = c[0] + factor * (start[1] - start[0]);
        c[2] = c[3] + factor * (start[2] - start[3]);
        return c;
    };
    double factor = 1.0;
    double other = 1.05;
    double error = length_of(curve) - length;
    double other_error = length_of(scaled(other)) - length;
    for (int step = 0; step < length_steps; ++step) {
        if (std::abs(error) <= length_share * length) {
            curve = scaled(factor);
            return true;
        }
        if (error == other_error)
            break;
        const double next = factor - error * (other - factor) / (other_error - error);
        other = factor;
        other_error = error;
        factor = std::clamp(next, 0.3, 2.0);
        error = length_of(scaled(factor)) - length;
    }
    return false;
}

// Points along a part of a polyline, with parameters in proportion to the arc.
struct Samples {
    std::vector<Vec2> points;
    std::vector<double> parameter;
    double length = 0.0;
};

Samples sample(const std::vector<Vec2>& points, std::size_t first, std::size_t last) {
    Samples samples;
    for (std::size_t i = first; i < last; ++i)
        samples.length += (points[i + 1] - points[i]).norm();
    double arc = 0.0;
    for (std::size_t i = first; i < last; ++i) {
        const double length = (points[i + 1] - points[i]).norm();
        const double wish = std::ceil(usual_samples * length / samples.length);
        const int count = std::max(least_samples, static_cast<int>(wish));
        for (int k = 0; k < count; ++k) {
            const double share = static_cast<double>(k) / count;
            samples.points.push_back(points[i] + share * (points[i + 1] - points[i]));
            samples.parameter.push_back((arc + share * length) / samples.length);
        }
        arc += length;
    }
    samples.points.push_back(points[last]);
    samples.parameter.push_back(1.0);
    return samples;
}

// Least squares for the lengths of both handles, with the directions given.
Control fit(const Samples& samples, const Vec2& start, const Vec2& end) {
    const Vec2& a = samples.points.front();
    const Vec2& b = samples.points.back();
    Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
    Vec2 rhs = Vec2::Zero();
    for (std::size_t i = 0; i < samples.points.size(); ++i) {
        const double t = samples.parameter[i];
        const double s = 1.0 - t;
        const Vec2 p = 3.0 * s * s * t * start;
        const Vec2 q = 3.0 * s * t * t * end;
        const Vec2 rest = samples.points[i] - s * s * (s + 3.0 * t) * a - t * t * (t + 3.0 * s) * b;
        matrix += (Eigen::Matrix2d() << p.dot(p), p.dot(q), p.dot(q), q.dot(q)).finished();
        rhs += Vec2(p.dot(rest), q.dot(rest));
    }
    Vec2 handles = matrix.inverse() * rhs;
    const double chord = (b - a).norm();
    const double least = 1e-3 * samples.length;
    if (!handles.allFinite() || handles.minCoeff() < least ||
        handles.maxCoeff() > longest_handle * samples.length)
        handles = Vec2::Constant(std::max(chord, least) / 3.0); // [Schneider]'s rule of thumb
    return {a, a + handles.x() * start, b + handles.y() * end, b};
}

// One Newton step for the parameter of the nearest point of the curve.
void improve_parameters(const Control& curve, Samples& samples) {
    for (std::size_t i = 1; i + 1 < samples.points.size(); ++i) {
        double& t = samples.parameter[i];
        const Vec2 off = evaluate(curve, t) - samples.points[i];
        const Vec2 first = derivative(curve, t);
        const double slope = first.squaredNorm() + off.dot(second_derivative(curve, t));
        if (slope > 0.0)
            t = std::clamp(t - off.dot(first) / slope, 0.0, 1.0);
    }
}

// Largest distance of a sample from the curve at its parameter.
double error_of(const Control& curve, const Samples& samples) {
    double worst = 0.0;
    for (std::size_t i = 0; i < samples.points.size(); ++i)
        worst = std::max(worst, (evaluate(curve, samples.parameter[i]) - samples.points[i]).norm());
    return worst;
}

OutlineCurve line(const std::vector<Vec2>& points, std::size_t first, std::size_t last) {
    OutlineCurve curve;
    const Vec2 third = (points[last] - points[first]) / 3.0;
    curve.control = {points[first], points[first] + third, points[last] - third, points[last]};
    curve.first = static_cast<Index>(first);
    curve.count = static_cast<Index>(last - first);
    return curve;
}

bool is_straight(const std::vector<Vec2>& points, std::size_t first, std::size_t last,
                 double tolerance) {
    const Vec2 along = points[last] - points[first];
    const double length = along.norm();
    double path = 0.0;
    for (std::size_t i = first; i < last; ++i)
        path += (points[i + 1] - points[i]).norm();
    if (path - length > line_share * path)
        return false;
    for (std::size_t i = first + 1; i < last; ++i) {
        const Vec2 p = points[i] - points[first];
        const double forward = p.dot(along) / length;
        if (!(length > 0.0) || forward < 0.0 || forward > length ||
            std::abs(plane::cross(along, p)) / length > tolerance)
            return false;
    }
    return true;
}

// The direction through a point of the polyline, between its neighbours.
Vec2 direction(const std::vector<Vec2>& points, std::size_t i) {
    const Vec2 before = i > 0 ? Vec2((points[i] - points[i - 1]).normalized()) : Vec2::Zero();
    const Vec2 after =
        i + 1 < points.size() ? Vec2((points[i + 1] - points[i]).normalized()) : Vec2::Zero();
    const Vec2 sum = before + after;
    return sum.norm() > 0.0 ? Vec2(sum.normalized()) : after;
}

// At an end of the polyline: the tangent of the parabola through three points. Each chord of a
// smooth curve leaves it by half of the angle to the next one.
Vec2 end_direction(const std::vector<Vec2>& points, bool at_start) {
    const std::size_t n = points.size();
    const Vec2 a = at_start ? points[0] : points[n - 1];
    const Vec2 p = at_start ? points[1] : points[n - 2];
    const Vec2 q = at_start ? points[2] : points[n - 3];
    const double s = (p - a).norm();
    const double t = s + (q - p).norm();
    const Vec2 tangent = (p - a) / s * (t / (t - s)) - (q - a) / t * (s / (t - s));
    return tangent.norm() > 0.0 ? Vec2(tangent.normalized()) : Vec2((p - a).normalized());
}

void fit_part(const std::vector<Vec2>& points, std::size_t first, std::size_t last,
              double tolerance, std::vector<OutlineCurve>& curves) {
    if (last == first + 1 || is_straight(points, first, last, 0.5 * tolerance)) {
        curves.push_back(line(points, first, last));
        return;
    }
    const Vec2 start = first == 0 ? end_direction(points, true) : direction(points, first);
    const Vec2 end =
        last + 1 == points.size() ? end_direction(points, false) : Vec2(-direction(points, last));
    Samples samples = sample(points, first, last);
    Control curve = fit(samples, start, end);
    for (int round = 0; round < fit_rounds && error_of(curve, samples) > tolerance; ++round) {
        improve_parameters(curve, samples);
        curve = fit(samples, start, end);
    }
    if (match_length(samples.length, curve) && error_of(curve, samples) <= tolerance) {
        curves.push_back(
            {curve, false, static_cast<Index>(first), static_cast<Index>(last - first)});
        return;
    }
    // The joint: the point of the outline that is farthest from the curve.
    std::size_t joint = first + 1;
    double worst = -1.0;
    for (std::size_t i = first + 1, k = 0; i < last; ++i) {
        while (samples.points[k] != points[i])
            ++k;
        const double off = (evaluate(curve, samples.parameter[k]) - points[i]).norm();
        if (off > worst) {
            worst = off;
            joint = i;
        }
    }
    fit_part(points, first, joint, tolerance, curves);
    fit_part(points, joint, last, tolerance, curves);
}

} // namespace

std::vector<OutlineCurve> fit_ring(const std::vector<Vec2>& ring, double corner_angle,
                                   double tolerance) {
    const std::size_t size = ring.size();
    std::vector<std::size_t> corners;
    for (std::size_t i = 0; i < size; ++i)
        if (plane::turn(ring[(i + size - 1) % size], ring[i], ring[(i + 1) % size]) > corner_angle)
            corners.push_back(i);
    if (corners.empty())
        corners.push_back(0);
    std::vector<OutlineCurve> curves;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const std::size_t first = corners[k];
        const std::size_t last = k + 1 < corners.size() ? corners[k + 1] : corners[0] + size;
        std::vector<Vec2> points;
        for (std::size_t i = first; i <= last; ++i)
            points.push_back(ring[i % size]);
        for (OutlineCurve& curve : fit_polyline(points, tolerance)) {
            curve.first = (curve.first + static_cast<Index>(first)) % static_cast<Index>(size);
            curves.push_back(curve);
        }
    }
    return curves;
}

std::vector<Vec2> flatten_curves(const std::vector<OutlineCurve>& curves, double sagitta) {
    std::vector<Vec2> points;
    for (const OutlineCurve& curve : curves) {
        const Control& c = curve.control;
        // A parabola whose second derivative is d leaves its chord by d / 8.
        const double bend =
            6.0 * std::max((c[0] - 2.0 * c[1] + c[2]).norm(), (c[1] - 2.0 * c[2] + c[3]).norm());
        const int count =
            curve.is_line ? 1 : static_cast<int>(std::ceil(std::sqrt(bend / (8.0 * sagitta))));
        for (int i = 0; i < count; ++i)
            points.push_back(evaluate(c, static_cast<double>(i) / count));
    }
    return points;
}

std::vector<OutlineCurve> fit_polyline(const std::vector<Vec2>& points, double tolerance) {
    std::vector<OutlineCurve> curves;
    if (tolerance > 0.0)
        fit_part(points, 0, points.size() - 1, tolerance, curves);
    else
        for (std::size_t i = 0; i + 1 < points.size(); ++i)
            curves.push_back(line(points, i, i + 1));
    return curves;
}

void fit_curves(std::vector<PatternPiece>& pieces, const std::vector<Chain>& chains,
                double tolerance) {
    std::map<std::tuple<Index, Index, Index>, Index> sides; // piece, path, first edge → edges
    for (const Chain& chain : chains)
        for (std::size_t s = 0; s < at(chain.side_count); ++s) {
            const SeamSide& side = chain.sides[s];
            if (side.count > 0)
                sides[{side.piece, side.path, side.first}] = side.count;
        }
    for (const auto& [key, count] : sides) {
        const auto& [piece, l, first] = key;
        PiecePath& path = pieces[piece].path(l);
        std::vector<Vec2> points;
        for (Index k = 0; k <= count; ++k)
            points.push_back(path.points[at(first + k) % path.points.size()]);
        for (OutlineCurve& curve : fit_polyline(points, tolerance)) {
            curve.first = (curve.first + first) % static_cast<Index>(path.points.size());
            path.curves.push_back(curve);
        }
    }
}

} // namespace devseg::pattern
