// As-rigid-as-possible flattening: from a given map towards the nearest isometry of every face.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/flatten/energy/laplacian.h"

namespace devseg::flatten {

struct ArapOptions {
    int max_rounds = 100;             // local and global steps at most
    double relative_tolerance = 1e-4; // stop when a round gains less than this share of the energy
};

struct ArapResult {
    std::vector<Vec2> uv; // #v
    double energy = 0.0; // Σ A ((σ₁ − 1)² + (σ₂ − 1)²) / Σ A [LZXGG08, equation 4]; 0 for isometry
    int rounds = 0;
    bool converged = false;
    Index flips = 0; // rounds may turn faces over, and turn them back
};

/// Minimises the as-rigid-as-possible energy from `start` (#v) by local and global steps; no round
/// raises it. Throws NumericalFailure when the linear system cannot be solved, Cancelled.
ArapResult minimise_arap(const FlatteningProblem& problem, const std::vector<Vec2>& start,
                         const ArapOptions& options, const Progress& progress);

/// The energy of any map.
double arap_energy(const FlatteningProblem& problem, const std::vector<Vec2>& uv);

/// The rotation nearest to the map of each face (#f), as the image of the unit vector along x: from
/// the face as FlatteningProblem lays it into the plane. uv is #v.
std::vector<Vec2> face_turns(const FlatteningProblem& problem, const std::vector<Vec2>& uv);

struct StitchOptions {
    int rounds = 2;                   // of minimise_arap, after the first map
    int most_rounds = 20;             // while faces are flipped
    double give_up_energy = infinite; // of minimise_arap, below which the map will not come
};

/// The map whose edges are, in the least squares sense, those of faces that are turned so: charts
/// that are joined, each with the turns of its own map, fit together along the common border. Faces
/// may stay flipped. Empty where the energy is hopeless. Throws NumericalFailure.
std::vector<Vec2> stitch(const FlatteningProblem& problem, const Laplacian& laplacian,
                         const std::vector<Vec2>& turns, const StitchOptions& options);

} // namespace devseg::flatten
