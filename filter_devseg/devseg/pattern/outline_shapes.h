// Outlines as shapes: what they are like however they are turned, and how one is laid onto another.
//
// References
//   C. T. Zahn, R. Z. Roskies: Fourier descriptors for plane closed curves. IEEE Transactions on
//   Computers C-21(3), 1972. Here of the points themselves, not of their tangents.
#pragma once

#include <array>
#include <complex>
#include <optional>
#include <vector>

#include "devseg/pattern/pattern.h"

namespace devseg::pattern {

/// p → turn · p + shift, in complex numbers.
struct Motion {
    std::complex<double> turn{1.0, 0.0};
    std::complex<double> shift{0.0, 0.0};

    Vec2 operator()(const Vec2& p) const;
    Motion inverse() const;
};

/// The sides of a closed outline, for the points of it that are nearest to many others.
class Sides {
public:
    explicit Sides(const std::vector<Vec2>& outline);
    Vec2 nearest(const Vec2& p) const;

private:
    struct Side {
        Vec2 start, along;
        Vec2 measure; // along, over its squared length: 0 where it has none
    };
    std::vector<Side> sides_;
};

/// The outlines of a piece around the middle of its box, as they are or mirrored, so that they turn
/// the same way. Fourier descriptors are of evenly spaced points of the first one: the shares that
/// turn once, twice, …, forth and then back.
struct Shape {
    static constexpr std::size_t frequencies = 6; // waves that tell shapes apart
    using Waves = std::array<std::complex<double>, 2 * frequencies>;

    std::vector<std::vector<Vec2>> outlines;
    std::vector<Sides> sides; // of each outline
    std::vector<Vec2> even;
    std::vector<Vec2> few; // of them
    Waves waves;

    Shape(const PatternPiece& piece, bool mirrored);
};

/// `count` points along a closed outline at equal distances, from its first point.
std::vector<Vec2> even_points(const std::vector<Vec2>& outline, std::size_t count);

/// How far evenly spaced points of two outlines of one shape are apart at most, in the mean square.
/// `longer`: the difference of their perimeters; `around`: that of one.
double most_apart(double longer, double around, double tolerance);

/// The motion that brings a onto b so that neither has a point farther than `tolerance` from the
/// other, if there is one. `longer`: the difference of their perimeters; `around`: that of a.
std::optional<Motion> same_shape(const Shape& a, const Shape& b, double longer, double around,
                                 double tolerance);

} // namespace devseg::pattern
