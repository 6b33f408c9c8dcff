// Trials of patches on one surface, none made twice.
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

} // namespace devseg::plush
