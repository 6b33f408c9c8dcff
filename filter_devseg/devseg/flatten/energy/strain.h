// Strain: how much longer or shorter lines of the cloth get, and maps with the least of it whose
// boundary keeps its lengths.
#pragma once

#include <memory>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/flatten/energy/contacts.h"
#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

/// Strain of a map as it is, not scaled.
struct Strain {
    double mean = 0.0;       // over the area on the surface
    double most_of_it = 0.0; // what 99 % of the area keeps
    double worst = 0.0;      // of a face

    /// The larger ones of both.
    void take_worse(const Strain& other);
};

/// Of each face (#f): max(Γ − 1, 1 − γ), with Γ ≥ γ the singular values of the map from the plane
/// to the surface; infinite where a face is flipped.
std::vector<double> face_strains(const FlatteningProblem& problem, const std::vector<Vec2>& uv);

/// The summary of strains (#f) by area (#f).
Strain measure_strain(const std::vector<double>& strain, const std::vector<double>& area);

/// Moves inner vertices until the area-weighted mean of exp(s (ψ − 1)) is least, with ψ the
/// symmetric Dirichlet density of a face and a steepness s that goes with its worst faces: they
/// count for most. The boundary stays. `uv` (#v) has no flips; nor has the result.
std::vector<Vec2> least_strain(const FlatteningProblem& problem, const std::vector<Vec2>& uv,
                               const Progress& progress);

/// The same for all vertices: the boundary may bend, and its edges keep their lengths but for a
/// small rest. Empty where the mean of ψ − 1 cannot be below `give_up` with such a boundary.
std::vector<Vec2> least_strain_with_boundary(const FlatteningProblem& problem,
                                             const std::vector<Vec2>& uv, double give_up,
                                             const Progress& progress);

/// The last part of that again and again, from maps whose boundary has its lengths, while contacts
/// push. The order of elimination is found once.
class BoundaryPush {
public:
    BoundaryPush(const FlatteningProblem& problem, const std::vector<Vec2>& uv);
    ~BoundaryPush();

    std::vector<Vec2> run(const std::vector<Vec2>& uv, const ContactPenalty& contacts,
                          const Progress& progress);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace devseg::flatten
