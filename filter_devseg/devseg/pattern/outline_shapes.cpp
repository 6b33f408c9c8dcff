#include "devseg/pattern/outline_shapes.h"

#include <algorithm>
#include <cmath>

#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// Places along an outline that are compared at first; afterwards each is brought to the nearest
// point of the other outline.
constexpr std::size_t places = 96;
constexpr std::size_t few_places = places / 4; // enough to see that most others are not alike
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

Vec2 mean(const std::vector<Vec2>& points) {
    Vec2 sum = Vec2::Zero();
    for (const Vec2& p : points)
        sum += p;
    return sum / static_cast<double>(points.size());
}

// The rigid motion that brings from[i] nearest to to[(i + offset) mod n], in the mean square.
// `error`: what is left.
Motion fit_motion(const std::vector<Vec2>& from, const std::vector<Vec2>& to, std::size_t offset,
                  double& error) {
    const std::size_t n = from.size();
    const Vec2 mean_from = mean(from);
    const Vec2 mean_to = mean(to);
    double along = 0.0;
    double across = 0.0;
    double spread = 0.0;
    for (std::size_t i = 0, j = offset; i < n; ++i, ++j) {
        j = j < n ? j : 0;
        const Vec2 a = from[i] - mean_from;
        const Vec2 b = to[j] - mean_to;
        along += a.dot(b);
        across += plane::cross(a, b);
        spread += a.squaredNorm() + b.squaredNorm();
    }
    const Complex product{along, across};
    const double size = std::abs(product);
    Motion motion;
    if (size > 0.0)
        motion.turn = product / size;
    motion.shift = number(mean_to) - motion.turn * number(mean_from);
    error = spread - 2.0 * size;
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

// Whether all points, moved, lie on one of the outlines from `first` to before `last`.
bool lie_on(const std::vector<Vec2>& points, const Sides* first, const Sides* last,
            const Motion& motion, double tolerance) {
    return std::all_of(points.begin(), points.end(), [&](const Vec2& p) {
        const Vec2 moved = motion(p);
        return std::any_of(first, last, [&](const Sides& sides) {
            return (sides.nearest(moved) - moved).norm() <= tolerance;
        });
    });
}

bool lies_on(const Shape& a, const Shape& b, const Motion& motion, double tolerance) {
    return std::all_of(a.outlines.begin(), a.outlines.end(), [&](const std::vector<Vec2>& outline) {
        return lie_on(outline, b.sides.data(), b.sides.data() + b.sides.size(), motion, tolerance);
    });
}

// Brings the points to the nearest ones of the outline, again and again. False, sooner, where even
// at the pace of the last round they would not get within the tolerance.
bool approach(const std::vector<Vec2>& points, const Sides& outline, double tolerance,
              Motion& motion) {
    const double small = static_cast<double>(points.size()) * tolerance * tolerance;
    double last = infinite;
    std::vector<Vec2> nearest(points.size());
    for (int left = motion_rounds - 1; left >= 0; --left) {
        std::transform(points.begin(), points.end(), nearest.begin(),
                       [&](const Vec2& p) { return outline.nearest(motion(p)); });
        double error = 0.0;
        motion = fit_motion(points, nearest, 0, error);
        if (!(error < settled * last))
            break;
        if (error * std::pow(error / last, left) > small)
            return false;
        last = error;
    }
    return true;
}

bool fits_from(const Shape& a, const Shape& b, Motion& motion, double tolerance) {
    return approach(a.even, b.sides.front(), tolerance, motion) &&
           lies_on(a, b, motion, tolerance) && lies_on(b, a, motion.inverse(), tolerance);
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

// Cosines and sines of how far each wave has turned where it begins at each place.
struct Turns {
    std::array<std::array<double, begins>, Shape::frequencies> cosine, sine;

    Turns() {
        for (std::size_t w = 0; w < Shape::frequencies; ++w)
            for (std::size_t i = 0; i < begins; ++i) {
                const auto steps = static_cast<double>((w + 1) * i % begins);
                cosine[w][i] = std::cos(2.0 * pi * steps / static_cast<double>(begins));
                sine[w][i] = std::sin(2.0 * pi * steps / static_cast<double>(begins));
            }
    }
};

// How far the points of two outlines are apart at least, in the mean square, however one of them is
// turned; higher Shape::frequencies only add to it. `begin`: where b's points then begin.
double least_distance(const Shape::Waves& a, const Shape::Waves& b, std::size_t& begin) {
    static const Turns turns;
    std::array<double, begins> real{};
    std::array<double, begins> imaginary{};
    double spread = 0.0;
    for (std::size_t w = 0; w < Shape::frequencies; ++w) {
        const std::size_t back = Shape::frequencies + w;
        const Complex p = std::conj(a[w]) * b[w];
        const Complex q = std::conj(a[back]) * b[back];
        spread += std::norm(a[w]) + std::norm(b[w]) + std::norm(a[back]) + std::norm(b[back]);
        // With z the turn of a beginning, p z + q conj(z).
        const Complex sum = p + q;
        const Complex difference = p - q;
        for (std::size_t i = 0; i < begins; ++i) {
            const double c = turns.cosine[w][i];
            const double s = turns.sine[w][i];
            real[i] += c * sum.real() - s * difference.imag();
            imaginary[i] += c * sum.imag() + s * difference.real();
        }
    }
    double most = -1.0;
    for (std::size_t i = 0; i < begins; ++i) {
        const double square = real[i] * real[i] + imaginary[i] * imaginary[i];
        if (square > most) {
            most = square;
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
      even(even_points(outlines.front(), places)), few(even_points(outlines.front(), few_places)),
      waves(waves_of(even)) {}

double most_apart(double longer, double around, double tolerance) {
    // Evenly spaced points of ragged outlines are not at the same places, but as far apart as half
    // of what one is longer at most; and between two beginnings.
    return 2.0 * tolerance + 0.5 * longer + 0.5 * around / static_cast<double>(begins);
}

std::optional<Motion> same_shape(const Shape& a, const Shape& b, double longer, double around,
                                 double tolerance) {
    const double apart = most_apart(longer, around, tolerance);
    std::size_t begin = 0;
    if (least_distance(a.waves, b.waves, begin) > apart)
        return std::nullopt;
    double error = 0.0;
    Motion motion = fit_motion(a.even, b.even, begin, error);
    if (error > apart * apart * static_cast<double>(places))
        return std::nullopt;
    // Most shapes are told apart by a few points.
    const Sides* rim = b.sides.data();
    Motion tried = motion;
    if (!lie_on(a.few, rim, rim + 1, motion, 2.0 * apart) ||
        !approach(a.few, *rim, tolerance, tried) ||
        !lie_on(a.even, rim, rim + 1, motion, 2.0 * apart) || !fits_from(a, b, motion, tolerance))
        return std::nullopt;
    return motion;
}

} // namespace devseg::pattern
