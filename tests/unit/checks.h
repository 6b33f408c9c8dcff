// Ways into the core that many tests share, and validators that do not rely on it.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devseg/atlas/charts.h"
#include "devseg/base/errors.h"
#include "devseg/flatten/energy/rest_shape.h"
#include "devseg/mesh/input_gate.h"

namespace devseg::checks {

Mesh gated(const mesh::RawMesh& raw);
/// Each connected component is a chart.
atlas::ChartMap components(const Mesh& mesh);
atlas::ChartMap components_cut_to_disks(const Mesh& mesh);

/// A mesh that is one chart, opened to a disk where it is none; holes are not kept.
struct Disk {
    explicit Disk(const mesh::RawMesh& raw);
    /// The edges whose middle (internal units) fulfils `cut` are cut first.
    Disk(const mesh::RawMesh& raw, const std::function<bool(const Vec3& middle)>& cut);

    Mesh mesh;
    atlas::ChartMap charts;
    atlas::ChartSurface surface;
    flatten::FlatteningProblem problem;
};

/// Invariants of mesh.h: twins are mutual and run in opposite directions, the faces around each
/// vertex form one fan, and no vertex is without faces.
testing::AssertionResult is_valid(const Mesh& mesh);
/// Labels 0 … count − 1, all used, each chart connected across edges that are no seams; seams
/// agree on both sides and lie between any two charts.
testing::AssertionResult is_valid(const Mesh& mesh, const atlas::ChartMap& charts);

/// V − E + F and the number of boundary loops of one chart, counted from positions of corners
/// joined by union-find, without ChartSurface.
struct Topology {
    Index euler = 0;
    Index loops = 0;
};
Topology topology(const Mesh& mesh, const atlas::ChartMap& charts, Index chart);
/// Whether the chart is a disk by these numbers, or a disk with holes that atlas/holes.h calls
/// flat.
testing::AssertionResult is_sound(const Mesh& mesh, const atlas::ChartMap& charts, Index chart);

/// Singular values of the map on face f, larger first, from lengths alone.
std::array<double, 2> stretches(const flatten::FlatteningProblem& problem,
                                const std::vector<Vec2>& uv, std::size_t f);
/// √(Σ A (σ₁² + σ₂²)/2 / Σ A) of the inverse map (from the plane to the surface).
double l2_stretch(const flatten::FlatteningProblem& problem, const std::vector<Vec2>& uv);
/// Faces whose signed area is not positive, in extended precision.
Index count_flips(const std::vector<Triangle>& faces, const std::vector<Vec2>& uv);

/// Area of the part of triangle a that lies in triangle b, by clipping.
using Corners = std::array<Vec2, 3>;
double common_area(const Corners& a, const Corners& b);

/// x as a 32-bit number. Through memory: some compilers (GCC 12.2 at -O2) drop conversions of two
/// neighbouring numbers to float and back.
inline double single(double x) {
    const volatile float stored = static_cast<float>(x);
    return static_cast<double>(stored);
}
inline Vec2 single(const Vec2& p) {
    return Vec2(single(p.x()), single(p.y()));
}

testing::AssertionResult contains(const std::string& text, const std::string& part);

/// The message of the error that `call` throws; a failure if it throws none or another one.
template <class Expected, class Call>
std::string error_of(Call call) {
    try {
        call();
    } catch (const Expected& error) {
        return error.what();
    } catch (const std::exception& error) {
        ADD_FAILURE() << "another exception: " << error.what();
        return {};
    }
    ADD_FAILURE() << "no exception";
    return {};
}

} // namespace devseg::checks
