// What every change of the seams of one surface is judged by.
#pragma once

#include <vector>

#include "devseg/methods/plush/patch_tester.h"
#include "devseg/methods/plush/seam_network.h"

namespace devseg::plush {

struct SeamSetting {
    const WorkingSurface& surface;
    const VertexGraph& graph;          // of the surface
    const SeamMarks& hard;             // 3 #F or empty: borders between materials, which stay
    const std::vector<double>& weight; // 3 #F
    PatchTester& tester;
    PatchTester& strict_tester;               // for large patches
    const std::vector<double>& cut_cost;      // 3 #F: of paths that cut patches
    const std::vector<double>& straight_cost; // 3 #F: of paths in place of seams
    int max_rounds = 10000;                   // of trials side by side

    const Mesh& mesh() const { return surface.mesh; }
};

/// By how much the seams cost less with the marks `after` than with those before, by the prices of
/// SeamCost: lengths, patches, acute corners and shapes of pieces. Minus infinity where a patch
/// that changes does not pass `tester`. Cheap for changes that cannot pay.
double saved_cost(const SeamSetting& setting, const SeamMarks& before, const SeamMarks& after,
                  PatchTester& tester, const Progress& progress);

} // namespace devseg::plush
