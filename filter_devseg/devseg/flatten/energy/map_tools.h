// Small things that all flattening methods need: Jacobians, orientation, scale, failure.
#pragma once

#include <vector>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/rest_shape.h"
#include "devseg/plane/plane.h"

namespace devseg::flatten {

using plane::orientation;

/// Violation at which the constraints of a map count as met, in radians or as a share of a length:
/// far below what could flip a triangle, far above rounding.
constexpr double constraint_met = 1e-8;

/// Gains like the last one that a descent may still hope for: what gives up early counts with them.
constexpr double gains_to_come = 4.0;

/// What find() returns, and an empty value where its equations have no solution (NumericalFailure):
/// that is no error as long as there is another way.
template <class Find>
auto attempt(Find find) -> decltype(find()) {
    try {
        return find();
    } catch (const NumericalFailure&) {
        return {};
    }
}

/// Throws NumericalFailure for charts with holes: for methods that place one boundary first.
void expect_no_holes(const FlatteningProblem& problem);

/// Jacobian of the map from the rest triangle of face f to the plane.
inline Eigen::Matrix2d jacobian(const FlatteningProblem& problem, const std::vector<Vec2>& uv,
                                std::size_t f) {
    const Triangle& t = problem.faces[f];
    Eigen::Matrix2d edges;
    edges.col(0) = uv[t[1]] - uv[t[0]];
    edges.col(1) = uv[t[2]] - uv[t[0]];
    return edges * problem.inverse[f];
}

/// Whether face f lies in the plane the right way round, and with an area.
bool is_positive(const std::vector<Triangle>& faces, const std::vector<Vec2>& uv, Face f);

/// Whether all faces around the origin of a half-edge do.
bool is_positive_around(const std::vector<Triangle>& faces, const std::vector<HalfEdge>& twin,
                        const std::vector<Vec2>& uv, HalfEdge leaving);

/// Faces that are not positively oriented in the plane.
Index count_flips(const FlatteningProblem& problem, const std::vector<Vec2>& uv);

/// Area of the map: the sum of the signed areas of its faces.
double map_area(const FlatteningProblem& problem, const std::vector<Vec2>& uv);

/// Γ, the larger singular value of the map from the plane to the surface on face f; not for faces
/// without area in the plane.
double face_stretch(const FlatteningProblem& problem, const std::vector<Vec2>& uv, std::size_t f);

/// The same of all faces (#f).
std::vector<double> face_stretches(const FlatteningProblem& problem, const std::vector<Vec2>& uv);

/// The largest of all faces, at least 1.
double largest_stretch(const FlatteningProblem& problem, const std::vector<Vec2>& uv);

/// Mean of (Γ² + γ²) / 2 over the area, with Γ and γ the singular values of the map from the plane
/// to the surface, as it is (not scaled).
double squared_l2_stretch(const FlatteningProblem& problem, const std::vector<Vec2>& uv);

/// Its root; infinite where a face is flipped.
double l2_stretch(const FlatteningProblem& problem, const std::vector<Vec2>& uv);

/// Least area of a face in the plane over its area on the surface; negative where one is flipped.
double least_area_ratio(const FlatteningProblem& problem, const std::vector<Vec2>& uv);

/// Scales the map so that its area is the chart's own, and moves its centre to the origin.
void scale_to_area(const FlatteningProblem& problem, std::vector<Vec2>& uv);

} // namespace devseg::flatten
