// Charts that are larger than pieces may be, cut into parts: along edges of the mesh, or straight
// through its faces where those are too long for that.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/atlas/texture.h"
#include "devseg/base/progress.h"

namespace devseg::pattern {

/// A mesh with its charts in the plane; faces and vertices that were added come last.
struct SplitLayout {
    Mesh mesh;
    CornerUv uv;                    // 3 #F
    std::vector<Index> source_face; // #F: face of the mesh as it was
    atlas::ChartMap charts;
    std::vector<std::uint8_t> cut; // 3 #F: 1 on both sides of the new cuts
};

/// Nothing is cut yet.
SplitLayout whole_layout(const Mesh& mesh, const CornerUv& uv, const atlas::ChartMap& charts);

/// What the least box around a chart may measure, in units of `uv`.
struct PieceLimit {
    double longest = 0.0;
    double widest = 0.0; // its shorter side
};

/// Cuts every chart that is larger than the limit across its long direction, into as few parts as
/// fit, until none is too large: along the shortest line of mesh edges within the stretch that
/// leaves both parts small enough, or straight through the faces in its middle where no such line
/// does. Edges within a flat region count ten times: parts end at folds. Both sides of a seam get
/// the same new vertices. Throws InvalidParameter for a limit that takes too many cuts, Cancelled.
void split_large_charts(const PieceLimit& limit, SplitLayout& layout, const Progress& progress);

} // namespace devseg::pattern
