// The numbers that everything is made of: indices, points, angles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

namespace devseg {

using Index = std::int32_t; // −1: none
using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Triangle = std::array<Index, 3>;

/// Position in the plane of corner k of face f at index 3 f + k.
using CornerUv = std::vector<Vec2>; // 3 #F

constexpr double pi = 3.14159265358979323846;
constexpr double degrees = pi / 180.0; // 45.0 * degrees: in radians
constexpr double infinite = std::numeric_limits<double>::infinity();

/// The nearest number of 32 bits. Volatile, because GCC 12 at -O2 drops the two conversions of the
/// last of an odd number of values when it makes vector instructions of them.
inline double in_32_bits(double x) {
    const volatile float single = static_cast<float>(x);
    return static_cast<double>(single);
}

/// Index is signed (−1 = none), the containers' sizes are not.
inline std::size_t at(Index i) {
    return static_cast<std::size_t>(i);
}

} // namespace devseg
