// What the pieces of a pattern become when they are sewn together and stuffed.
//
// References
//   S. Bouaziz, S. Martin, T. Liu, L. Kavan, M. Pauly: Projective Dynamics: Fusing Constraint
//   Projections for Fast Simulation. ACM Transactions on Graphics 33(4), 2014.
//   doi:10.1145/2601097.2601116
#pragma once

#include <vector>

#include "devseg/atlas/texture.h"
#include "devseg/base/option_checks.h"
#include "devseg/base/progress.h"

namespace devseg::pattern {

struct SewnOptions {
    double stuffing = 0.01;   // how much the cloth is stretched by what is inside: 0.01 = 1 %
    int max_iterations = 300; // steps of the simulation at most

    static OptionRanges<SewnOptions> ranges() {
        return {{&SewnOptions::stuffing, {"stuffing", 0.0, 0.2}},
                {&SewnOptions::max_iterations, {"max_iterations", 1, 1e6}}};
    }
};

struct SewnPreview {
    std::vector<Vec3> points;      // #V, internal units
    std::vector<double> distance;  // #V, to the surface, internal units
    double mean_distance = 0.0;    // over the area, as a share of the bounding box's diagonal
    double largest_distance = 0.0; // as a share of the diagonal
    int rounds = 0;
    bool converged = false; // steps had become small
    double stuffing = 0.0;  // less than was asked for where a net of few long faces would burst
};

/// The surface as cloth that has the lengths of the pieces on paper (`uv`, 3 #F) and is sewn along
/// all seams: springs along edges, as long as in the plane (on seams the mean of both sides),
/// against the pressure of the stuffing, from the surface without its details to rest. The result
/// is moved and turned onto the surface. Throws InvalidMesh for coordinates without area, and
/// NumericalFailure.
SewnPreview sew_and_inflate(const Mesh& mesh, const CornerUv& uv, const SewnOptions& options,
                            Progress& progress);

} // namespace devseg::pattern
