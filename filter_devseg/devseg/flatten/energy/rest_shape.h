// The triangles of a chart as they are in space, laid into the plane one by one: what every
// flattening method compares its map with.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>

#include "devseg/atlas/charts.h"

namespace devseg::flatten {

/// A chart that is ready to be flattened. Positions are in internal units of the mesh.
struct FlatteningProblem {
    Index vertex_count = 0;
    std::vector<Triangle> faces;           // #f local vertices
    std::vector<HalfEdge> twin;            // 3 #f: the opposite half-edge, −1 on the boundary
    std::vector<Index> boundary;           // vertices of the rim, counterclockwise
    std::vector<double> boundary_edge;     // length of the edge from boundary[i] to boundary[i + 1]
    std::vector<std::vector<Index>> holes; // vertices of each other boundary loop, clockwise
    std::vector<Eigen::Matrix2d> edges;    // #f: columns are the edges 0→1 and 0→2 of the face
    std::vector<Eigen::Matrix2d> inverse;  // #f: the inverse of `edges`
    std::vector<double> area;              // #f
    std::vector<std::array<double, 3>> cotangent; // #f: of the angle opposite to edge k → k + 1
    std::vector<double> given_area;               // #f: on the mesh, before needles are widened
    double total_area = 0.0;
    double model_size = 0.0; // root of the whole mesh's area, which gaps and tolerances refer to

    /// Corner k of face f as it is laid into the plane.
    Vec2 corner(Face f, Index k) const {
        return k == 0 ? Vec2(0.0, 0.0) : Vec2(edges[f].col(k - 1));
    }
};

/// One triangle laid into the plane.
struct RestTriangle {
    Eigen::Matrix2d edges; // columns are the edges 0→1 and 0→2
    double area = 0.0;
    std::array<double, 3> cotangent{}; // of the angle opposite to edge k → k + 1
};

/// The triangle with these edge lengths (k → k + 1); lengths that make it too thin to have a shape
/// are widened, and none is shorter than `floor` times a small factor.
RestTriangle make_rest_triangle(std::array<double, 3> length, double floor);

/// Throws NumericalFailure unless the surface is sound (see atlas/holes.h): a disk, or a disk with
/// holes that lie flat. Triangles that are too thin to have a
/// shape of their own in double precision are given the least extra width that makes them solid
/// (all three lengths grow by the same amount, as in intrinsic mollification), so that every
/// energy and angle stays finite.
FlatteningProblem make_flattening_problem(const Mesh& mesh, const atlas::ChartSurface& surface);

/// Some faces of a chart as a problem of its own, without a boundary.
struct PartialProblem {
    FlatteningProblem problem;
    std::vector<Index> vertex;       // #v: its index in the chart
    std::vector<std::uint8_t> fixed; // #v: 1 for those of other faces too
};
PartialProblem part_of(const FlatteningProblem& whole, const std::vector<Index>& faces);

} // namespace devseg::flatten
