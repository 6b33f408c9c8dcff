// Deformation to exact developability: vertices move until the angles around every inner vertex of
// every chart sum up to 2π. Connectivity stays, borders and slits are free.
//
// References
//   [TTY15] K. Takahashi, T. Tachi, Y. Yamaguchi: Mesh Approximation for Generating Development
//   with
//           Creases and Slits. Journal for Geometry and Graphics 19(1), 2015, section 3.2.3.
//   [T10]   T. Tachi: Freeform Variations of Origami. Journal for Geometry and Graphics 14(2), 2010
//           (the projection by the least displacement)
//   [D11]   P. Deuflhard: Newton Methods for Nonlinear Problems. Springer, 2011, section 3.3 (the
//           natural monotonicity test)
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/option_checks.h"
#include "devseg/base/progress.h"

namespace devseg::develop {

struct DeformOptions {
    int max_iterations = 100;
    double tolerance = 1e-6;      // radians, at every inner vertex
    bool adjust_slits = true;     // see below
    bool keep_unfinished = false; // return the best state instead of throwing
    bool keep_holes = true;       // of flat faces exact (stiff_faces.h): what is around them stays
    // With `adjust_slits`, shares of the diagonal of the mesh's box; 0: no bound.
    double max_displacement = 0.03;
    double max_mean_displacement = 0.003;

    static OptionRanges<DeformOptions> ranges() {
        return {{&DeformOptions::max_iterations, {"max_iterations", 1, 1e6}},
                {&DeformOptions::tolerance, {"tolerance", 1e-10, 1.0}},
                {&DeformOptions::max_displacement, {"max_displacement", 0.0, 1.0}},
                {&DeformOptions::max_mean_displacement, {"max_mean_displacement", 0.0, 1.0}}};
    }
};

struct DeformResult {
    std::vector<Vec3> points; // #V, internal units
    atlas::ChartMap charts;   // the given ones, with the slits that were added
    bool converged = false;
    double residual = 0.0;       // largest angle defect of an inner vertex, radians
    double start_residual = 0.0; // before the deformation
    int rounds = 0;
    Index inner_vertices = 0;
    Index added_slits = 0;
    Index closed_edges = 0;            // of slits
    Index moved_parts = 0;             // that went to other charts (moved_parts.h)
    Index new_intersections = 0;       // pairs of faces that intersect and did not before
    double largest_displacement = 0.0; // internal units
    double mean_displacement = 0.0;
};

/// With `adjust_slits`, slits are cut to the vertices that cannot be made developable, and closed
/// from tips with more than 2π around them, where their sides would overlap in the plane. Where an
/// attempt misses the tolerance, makes the surface cross itself or moves vertices too far, the next
/// one begins with more slits there (attempts.h), until none does.
///
/// `point_of` (#V) tells vertices that must stay together by equal numbers 0 … n − 1. A vertex is
/// inner if none of its edges is cut and it is not on the mesh's boundary; a slit's tip is not.
/// Throws InvalidParameter, and NumericalFailure where the tolerance is not reached.
DeformResult deform_to_developable(const Mesh& mesh, const atlas::ChartMap& charts,
                                   const std::vector<Index>& point_of, const DeformOptions& options,
                                   Progress& progress);

/// The inner vertices of all charts, ascending.
std::vector<Index> inner_vertices(const Mesh& mesh, const std::vector<std::uint8_t>& seam);

} // namespace devseg::develop
