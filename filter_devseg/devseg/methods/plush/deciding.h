// Deciding on the seams of one surface: what they follow, candidates, their removal, and what is
// left over.
#pragma once

#include "devseg/methods/plush/mend_patches.h"
#include "devseg/methods/plush/plush_seams.h"

namespace devseg::plush {

/// What seams of one surface are decided by.
struct Evidence {
    const WorkingSurface& surface;
    VertexGraph graph;
    Skeleton skeleton;
    std::vector<double> curvature; // #V
    SeamWeights weights;
    std::vector<Index> extrema;
    SeamMarks limb_borders; // 3 #F, as they were found
};

Evidence find_evidence(const WorkingSurface& surface, const PlushOptions& options,
                       Skeleton skeleton, PlushSeams& result, Progress& progress);

/// What the seams of the surface follow.
SeamGuides guides_of(const Evidence& evidence);

/// Of half-edges as parts of paths along seams of another surface: factors of their lengths.
std::vector<double> transfer_factors(const Evidence& evidence, const PlushOptions& options);

/// A share of what the model must keep.
judge::ClothLimits limits_of(const PlushOptions& options, double share, bool is_search);

/// Seams of the open part. `hard` has all seams that are not inside of it; or is empty. `share`: of
/// the limits.
SeamMarks decide(Evidence& evidence, const OpenPart& open, const SeamMarks& hard, double share,
                 const PlushOptions& options, PlushSeams& result, Progress& progress);

/// Seams with which small patches and thin tongues are given to neighbours. `share`: as above. To
/// keep pairs, tongues stay, and only the smallest patches go.
SeamMarks without_remnants(const Evidence& evidence, SeamMarks seam, const SeamMarks& hard,
                           double share, const PlushOptions& options, PlushSeams& result,
                           Progress& progress, bool keep_pairs = false);

} // namespace devseg::plush
