#include "devseg/pattern/outline_shapes.h"

#include <algorithm>
#include <cmath>

#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// Places along an outline that are compared at first; afterwards each is brought to the nearest
// point of the other outline.
constexpr std::size_t places = 96;
constexpr int motion_rounds = 12;
// Sooner when the squared distance falls no more below this share of it.
constexpr double settled = 0.98;

// Beginnings along an outline that are tried with its waves.
constexpr std::size_t begins = places;

using Complex = std::complex<double>;

Complex number(const Vec2& p) {
    return {p.x(), p.y()};
}

Vec2 point(const Complex& z) {
    return {z.real(), z.imag()};
}

// The rigid motion that brings from[i] nearest to to[(i + offset) mod n], in the mean square.
// `error`: what is left.
Motion fit_motion(const std::vector<Vec2>& from, const std::vector<Vec2>& to, std::size_t offset,
                  double& error) {
    const std::size_t n = from.size();
    Complex mean_from{0.0, 0.0};
    Complex mean_to{0.0, 0.0};
    for (std::size_t i = 0; i < n; ++i) {
        mean_from += number(from[i]) / static_cast<double>(n);
        mean_to += number(to[i]) / static_cast<double>(n);
    }
    Complex product{0.0, 0.0};
    double spread = 0.0;
    for (std::size_t i = 0, j = offset; i < n; ++i, ++j) {
        j = j < n ? j : 0;
        const Complex a = number(from[i]) - mean_from;
        const Complex b = number(to[j]) - mean_to;
        product += std::conj(a) * b;
        spread += std::norm(a) + std::norm(b);
    }
    Motion motion;
    if (std::abs(product) > 0.0)
        motion.turn = product / std::abs(product);
    motion.shift = mean_to - motion.turn * mean_from;
    error = spread - 2.0 * std::abs(product);
    return motion;
}

// Outlines around the piece's own origin, as they are or mirrored, so that they turn the same way.
std::vector<std::vector<Vec2>> outlines_of(const PatternPiece& piece, bool mirrored) {
    std::vector<std::vector<Vec2>> outlines;
    for (Index l = 0; l < piece.path_count(); ++l) {
        outlines.push_back(piece.path(l).points);
        for (Vec2& p : outlines.back()) {
            p -= piece.box.center();
            if (mirrored)
                p.x() = -p.x();
        }
        if (mirrored)
            std::reverse(outlines.back().begin(), outlines.back().end());
    }
    return outlines;
}

// Whether all points, moved, lie on one of the outlines.
bool lie_on(const std::vector<Vec2>& points, const std::vector<Sides>& outlines,
            const Motion& motion, double tolerance) {
    return std::all_of(points.begin(), points.end(), [&](const Vec2& p) {
        const Vec2 moved = motion(p);
        return std::any_of(outlines.begin(), outlines.end(), [&](const Sides& sides) {
            return (sides.nearest(moved) - moved).norm() <= tolerance;
        });
    });
}

bool lies_on(const Shape& a, const Shape& b, const Motion& motion, double tolerance) {
    return std::all_of(a.outlines.begin(), a.outlines.end(), [&](const std::vector<Vec2>& outline) {
        return lie_on(outline, b.sides, motion, tolerance);
    });
}

// Brings the points to the nearest ones of the other outline, again and again.
bool fits_from(const Shape& a, const Shape& b, Motion& motion, double tolerance) {
    double last = infinite;
    std::vector<Vec2> nearest(a.even.size());
    for (int round = 0; round < motion_rounds; ++round) {
        std::transform(a.even.begin(), a.even.end(), nearest.begin(),
                       [&](const Vec2& p) { return b.sides.front().nearest(motion(p)); });
        double error = 0.0;
        motion = fit_motion(a.even, nearest, 0, error);
        if (!(error < settled * last))
            break;
        last = error;
    }
    return lies_on(a, b, motion, tolerance) && lies_on(b, a, motion.inverse(), tolerance);
}

double frequency(std::size_t wave) {
    const double once = static_cast<double>(wave % Shape::frequencies + 1);
    return wave < Shape::frequencies ? once : -once;
}

Shape::Waves waves_of(const std::vector<Vec2>& points) {
    const double share = 1.0 / static_cast<double>(points.size());
    Shape::Waves waves{};
    for (std::size_t w = 0; w < waves.size(); ++w) {
        const Complex step = std::polar(1.0, -2.0 * pi * share * frequency(w));
        Complex turn{share, 0.0};
        for (const Vec2& p : points) {
            waves[w] += turn * number(p);
            turn *= step;
        }
    }
    return waves;
}

// How far the points of two outlines are apart at least, in the mean square, however one of them is
// turned; higher Shape::frequencies only add to it. `begin`: where b's points then begin.
double least_distance(const Shape::Waves& a, const Shape::Waves& b, std::size_t& begin) {
    Shape::Waves products;
    double spread = 0.0;
    for (std::size_t w = 0; w < products.size(); ++w) {
        products[w] = std::conj(a[w]) * b[w];
        spread += std::norm(a[w]) + std::norm(b[w]);
    }
    double most = -1.0;
    const Complex next = std::polar(1.0, 2.0 * pi / static_cast<double>(begins));
    Complex step{1.0, 0.0};
    for (std::size_t i = 0; i < begins; ++i, step *= next) {
        Complex forth = step;
        Complex sum{0.0, 0.0};
        for (std::size_t w = 0; w < Shape::frequencies; ++w, forth *= step)
            sum += forth * products[w] + std::conj(forth) * products[Shape::frequencies + w];
        if (std::norm(sum) > most) {
            most = std::norm(sum);
            begin = i;
        }
    }
    return std::sqrt(std::max(0.0, spread - 2.0 * std::sqrt(most)));
}

} // namespace

Vec2 Motion::operator()(const Vec2& p) const {
    return point(turn * number(p) + shift);
}

Motion Motion::inverse() const {
    return {std::conj(turn), -std::conj(turn) * shift};
}

Sides::Sides(const std::vector<Vec2>& outline) {
    for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
        const Vec2 along = outline[i] - outline[j];
        const double length = along.squaredNorm();
        sides_.push_back({outline[j], along, length > 0.0 ? Vec2(along / length) : Vec2(0.0, 0.0)});
    }
}

Vec2 Sides::nearest(const Vec2& p) const {
    Vec2 best = sides_.front().start;
    double least = infinite;
    for (const Side& side : sides_) {
        const Vec2 from_start = p - side.start;
        const double share = std::min(1.0, std::max(0.0, from_start.dot(side.measure)));
        const double distance = (from_start - share * side.along).squaredNorm();
        if (distance < least) {
            least = distance;
            best = side.start + share * side.along;
        }
    }
    return best;
}

std::vector<Vec2> even_points(const std::vector<Vec2>& outline, std::size_t count) {
    const double step = plane::perimeter(outline) / static_cast<double>(count);
    std::vector<Vec2> result;
    double arc = 0.0;
    for (std::size_t i = 0; i < outline.size() && result.size() < count; ++i) {
        const Vec2 along = outline[(i + 1) % outline.size()] - outline[i];
        const double length = along.norm();
        while (result.size() < count && static_cast<double>(result.size()) * step < arc + length)
            result.push_back(outline[i] +
                             (static_cast<double>(result.size()) * step - arc) / length * along);
        arc += length;
    }
    result.resize(count, outline.front());
    return result;
}

Shape::Shape(const PatternPiece& piece, bool mirrored)
    : outlines(outlines_of(piece, mirrored)), sides(outlines.begin(), outlines.end()),
      even(even_points(outlines.front(), places)), waves(waves_of(even)) {}

std::optional<Motion> same_shape(const Shape& a, const Shape& b, double longer, double around,
                                 double tolerance) {
    // Evenly spaced points of ragged outlines are not at the same places, but as far apart as half
    // of what one is longer at most; and between two beginnings.
    const double apart =
        2.0 * tolerance + 0.5 * longer + 0.5 * around / static_cast<double>(begins);
    std::size_t begin = 0;
    if (least_distance(a.waves, b.waves, begin) > apart)
        return std::nullopt;
    double error = 0.0;
    Motion motion = fit_motion(a.even, b.even, begin, error);
    if (!lie_on(a.even, {b.sides.front()}, motion, 2.0 * apart) ||
        !fits_from(a, b, motion, tolerance))
        return std::nullopt;
    return motion;
}

} // namespace devseg::pattern
