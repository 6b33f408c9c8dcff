// Trials of patches on one surface, none made twice, and all that seams are judged by there.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/judge/cloth.h"
#include "devseg/methods/plush/working_surface.h"

namespace devseg::plush {

/// Trials on one surface. None is made twice: a patch and its mirror image are one. Threads may
/// share it.
class PatchTester {
public:
    PatchTester(const WorkingSurface& surface, const judge::ClothLimits& limits)
        : surface_(surface), limits_(limits) {}

    /// Whether the patch is developable. `seam` as for try_cloth, symmetric where the surface is.
    bool accepts(const std::vector<Index>& faces, const std::vector<std::uint8_t>& seam,
                 const Progress& progress);
    bool accepts_all(const std::vector<std::vector<Index>>& patches,
                     const std::vector<std::uint8_t>& seam, const Progress& progress);
    const judge::ClothLimits& limits() const { return limits_; }

private:
    const WorkingSurface& surface_;
    const judge::ClothLimits limits_;
    std::mutex mutex_;
    std::map<std::vector<Index>, bool> known_; // 8 f + marks of its edges
};

/// What seams are judged by.
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

} // namespace devseg::plush
