// References
//   C. T. Zahn, R. Z. Roskies: Fourier descriptors for plane closed curves. IEEE Transactions on
//   Computers C-21(3), 1972. Here of the points themselves, not of their tangents.
#include "devseg/pattern/same_pieces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <optional>

#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// Places along an outline that are compared at first; afterwards each is brought to the nearest
// point of the other outline.
constexpr std::size_t places = 96;
constexpr int motion_rounds = 12;
// Sooner when the squared distance falls no more below this share of it.
constexpr double settled = 0.98;

// Two pieces of one shape differ by less than this share of their size, whatever the tolerance.
constexpr double size_share = 0.01;

// Outlines of one shape differ in length by less than this share, however ragged they are.
constexpr double length_raggedness = 0.1;

// Waves along an outline that tell shapes apart, and the beginnings that are tried with them.
constexpr std::size_t frequencies = 6;
constexpr std::size_t begins = places;

// Models that a piece is compared with, the most similar ones: thousands of pieces of as many
// shapes must not be compared each with each.
constexpr std::size_t closest_models = 8;

using Complex = std::complex<double>;

Complex number(const Vec2& p) {
    return {p.x(), p.y()};
}

Vec2 point(const Complex& z) {
    return {z.real(), z.imag()};
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

Vec2 nearest_on(const std::vector<Vec2>& outline, const Vec2& p) {
    Vec2 best = outline.front();
    double least = infinite;
    for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
        const Vec2 q = plane::nearest_point(p, outline[j], outline[i]);
        if ((p - q).squaredNorm() < least) {
            least = (p - q).squaredNorm();
            best = q;
        }
    }
    return best;
}

// p → turn · p + shift, in complex numbers.
struct Motion {
    Complex turn{1.0, 0.0};
    Complex shift{0.0, 0.0};

    Vec2 operator()(const Vec2& p) const { return point(turn * number(p) + shift); }
};

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
    for (std::size_t i = 0; i < n; ++i) {
        const Complex a = number(from[i]) - mean_from;
        const Complex b = number(to[(i + offset) % n]) - mean_to;
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

// Whether all of `a`, moved, lies on an outline of `b`.
bool lies_on(const std::vector<std::vector<Vec2>>& a, const std::vector<std::vector<Vec2>>& b,
             const Motion& motion, double tolerance) {
    for (const std::vector<Vec2>& outline : a)
        for (const Vec2& p : outline) {
            const Vec2 moved = motion(p);
            bool near = false;
            for (const std::vector<Vec2>& other : b)
                near = near || (nearest_on(other, moved) - moved).norm() <= tolerance;
            if (!near)
                return false;
        }
    return true;
}

// Brings the points to the nearest ones of the other outline, again and again.
bool fits_from(const std::vector<std::vector<Vec2>>& a, const std::vector<std::vector<Vec2>>& b,
               const std::vector<Vec2>& even, Motion& motion, double tolerance) {
    double last = infinite;
    for (int round = 0; round < motion_rounds; ++round) {
        std::vector<Vec2> nearest;
        for (const Vec2& p : even)
            nearest.push_back(nearest_on(b.front(), motion(p)));
        double error = 0.0;
        motion = fit_motion(even, nearest, 0, error);
        if (!(error < settled * last))
            break;
        last = error;
    }
    const Motion back{std::conj(motion.turn), -std::conj(motion.turn) * motion.shift};
    return lies_on(a, b, motion, tolerance) && lies_on(b, a, back, tolerance);
}

// Fourier descriptors of evenly spaced points: shares that turn once, twice, …, forth and then
// back.
using Waves = std::array<Complex, 2 * frequencies>;

double frequency(std::size_t wave) {
    const double once = static_cast<double>(wave % frequencies + 1);
    return wave < frequencies ? once : -once;
}

Waves waves_of(const std::vector<Vec2>& points) {
    const double share = 1.0 / static_cast<double>(points.size());
    Waves waves{};
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

// The outlines of a piece, as they are or mirrored.
struct Shape {
    std::vector<std::vector<Vec2>> outlines;
    std::vector<Vec2> even; // points of the first one
    Waves waves;

    Shape(const PatternPiece& piece, bool mirrored)
        : outlines(outlines_of(piece, mirrored)), even(even_points(outlines.front(), places)),
          waves(waves_of(even)) {}
};

// How far the points of two outlines are apart at least, in the mean square, however one of them is
// turned; higher frequencies only add to it. `begin`: where b's points then begin.
double least_distance(const Waves& a, const Waves& b, std::size_t& begin) {
    Waves products;
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
        for (std::size_t w = 0; w < frequencies; ++w, forth *= step)
            sum += forth * products[w] + std::conj(forth) * products[frequencies + w];
        if (std::abs(sum) > most) {
            most = std::abs(sum);
            begin = i;
        }
    }
    return std::sqrt(std::max(0.0, spread - 2.0 * most));
}

// What pieces of one shape agree on, however they are turned or mirrored.
struct Signature {
    double around = 0.0;                             // length of the outline
    std::array<double, 2 * frequencies> strengths{}; // of its waves

    Signature(const PatternPiece& piece, const Shape& shape)
        : around(plane::perimeter(piece.outer.points)) {
        for (std::size_t w = 0; w < strengths.size(); ++w)
            strengths[w] = std::abs(shape.waves[w]);
    }

    double squared_distance(const Signature& other) const {
        double sum = 0.0;
        for (std::size_t w = 0; w < strengths.size(); ++w)
            sum += (strengths[w] - other.strengths[w]) * (strengths[w] - other.strengths[w]);
        return sum;
    }
};

struct Known {
    std::size_t piece = 0;
    Shape shape;
    Signature signature;
};

bool may_be_same(const PatternPiece& a, const PatternPiece& b, const Signature& of_a,
                 const Signature& of_b, double tolerance) {
    // An outline that moves by d changes the area by d times its length at most, and each of its
    // edges by twice d.
    const double edges =
        static_cast<double>(std::max(a.outer.points.size(), b.outer.points.size()));
    return a.holes.size() == b.holes.size() &&
           std::abs(a.area - b.area) <= tolerance * std::max(of_a.around, of_b.around) &&
           std::abs(of_a.around - of_b.around) <=
               std::min(length_raggedness * of_a.around, 2.0 * tolerance * edges);
}

// The motion that brings a onto b, if there is one.
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
    if (!lies_on({a.even}, {b.outlines.front()}, motion, 2.0 * apart) ||
        !fits_from(a.outlines, b.outlines, a.even, motion, tolerance))
        return std::nullopt;
    return motion;
}

// The models that are most similar, in their order.
std::vector<std::size_t> closest(const std::vector<Known>& models,
                                 const std::vector<PatternPiece>& pieces, const PatternPiece& piece,
                                 const Signature& signature, double tolerance) {
    std::vector<std::pair<double, std::size_t>> found;
    for (std::size_t m = 0; m < models.size(); ++m) {
        const Known& model = models[m];
        if (!may_be_same(piece, pieces[model.piece], signature, model.signature, tolerance))
            continue;
        const double distance = signature.squared_distance(model.signature);
        if (found.size() == closest_models && !(distance < found.back().first))
            continue;
        if (found.size() == closest_models)
            found.pop_back();
        const std::pair<double, std::size_t> entry{distance, m};
        found.insert(std::upper_bound(found.begin(), found.end(), entry), entry);
    }
    std::vector<std::size_t> result;
    for (const auto& entry : found)
        result.push_back(entry.second);
    std::sort(result.begin(), result.end());
    return result;
}

double tolerance_for(const PatternPiece& piece, double tolerance_mm) {
    return std::min(tolerance_mm, size_share * std::sqrt(piece.area));
}

} // namespace

std::optional<MirrorAxis> find_mirror_axis(const PatternPiece& piece, double tolerance_mm) {
    const double around = plane::perimeter(piece.outer.points);
    const auto motion = same_shape(Shape(piece, true), Shape(piece, false), 0.0, around,
                                   tolerance_for(piece, tolerance_mm));
    if (!motion)
        return std::nullopt;
    // In complex numbers around the middle of the box, the mirror image of z is −turn z̄ + shift:
    // its axis has half the angle of −turn, and half of the shift lies on it.
    const double angle = 0.5 * std::arg(-motion->turn);
    return MirrorAxis{piece.box.center() + 0.5 * point(motion->shift),
                      Vec2(std::cos(angle), std::sin(angle))};
}

void find_same_pieces(std::vector<PatternPiece>& pieces, double tolerance_mm,
                      const Progress& progress) {
    std::vector<Known> models;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        progress.check();
        PatternPiece& piece = pieces[i];
        piece.model = static_cast<Index>(i);
        piece.mirrored = false;
        piece.quantity = 1;
        piece.mirrored_quantity = 0;
        const double tolerance = tolerance_for(piece, tolerance_mm);
        Shape straight(piece, false);
        const Signature signature(piece, straight);
        const Shape mirrored(piece, true);
        for (const std::size_t m : closest(models, pieces, piece, signature, tolerance)) {
            const double longer = std::abs(signature.around - models[m].signature.around);
            const auto is_same = [&](const Shape& shape) {
                return same_shape(shape, models[m].shape, longer, signature.around, tolerance)
                    .has_value();
            };
            const bool same = is_same(straight);
            if (!same && !is_same(mirrored))
                continue;
            PatternPiece& model = pieces[models[m].piece];
            piece.model = static_cast<Index>(models[m].piece);
            piece.mirrored = !same;
            piece.quantity = 0;
            ++(same ? model.quantity : model.mirrored_quantity);
            break;
        }
        if (piece.quantity > 0)
            models.push_back({i, std::move(straight), signature});
    }
}

} // namespace devseg::pattern
