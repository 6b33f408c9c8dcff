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

/// What a trial says of a patch.
struct Verdict {
    bool accepted = false;
    // Of its narrowest neck, see narrowest_neck; least_width where it has none below.
    double width = 0.0;
};

/// Trials on one surface. None is made twice: a patch and its mirror image are one. Threads may
/// share it.
class PatchTester {
public:
    /// `least_width`: see Verdict.
    PatchTester(const WorkingSurface& surface, const judge::ClothLimits& limits,
                double least_width = 0.0)
        : surface_(surface), limits_(limits), least_width_(least_width) {}

    /// `seam` as for try_cloth, symmetric where the surface is.
    Verdict judge(const std::vector<Index>& faces, const std::vector<std::uint8_t>& seam,
                  const Progress& progress);
    /// Whether the patch is developable.
    bool accepts(const std::vector<Index>& faces, const std::vector<std::uint8_t>& seam,
                 const Progress& progress);
    bool accepts_all(const std::vector<std::vector<Index>>& patches,
                     const std::vector<std::uint8_t>& seam, const Progress& progress);
    const judge::ClothLimits& limits() const { return limits_; }
    double least_width() const { return least_width_; }

private:
    const WorkingSurface& surface_;
    const judge::ClothLimits limits_;
    const double least_width_;
    std::mutex mutex_;
    std::map<std::vector<Index>, Verdict> known_; // 8 f + marks of its edges
};

} // namespace devseg::plush
