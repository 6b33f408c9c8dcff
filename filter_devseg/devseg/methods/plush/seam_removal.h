// Taking seams away that are not needed, by trial flattenings.
#pragma once

#include "devseg/methods/plush/patch_tester.h"

namespace devseg::plush {

struct RemovalOptions {
    // What goes first: powers of the mean weight of a segment's edges [Plush: 1] and of the
    // smaller patch's size.
    double weight_power = 2.0;
    double size_power = 0.5;
    int random_seed = 0;        // other numbers than 0 change the order a little
    double most_together = 0.2; // of the surface: larger patches must pass the strict tester
    // Of joins: only patches up to this share of the surface are joined to a neighbour, along at
    // least so much of the root of their area.
    double most_area = 1.0;
    double least_neck = 0.3;
};

/// Removes segments, the least natural first, together with their mirror images, as long as all
/// patches that grow stay developable; seams that end inside a patch are darts. Returns how many
/// removals were tried, as do the others.
Index remove_seams(const SeamSetting& setting, const RemovalOptions& options, SeamMarks& seam,
                   Progress& progress);

/// Joins patches, the smallest first, where only a part of the seam between them can be removed:
/// what stays of it are darts. The part is as long as possible.
Index join_patches(const SeamSetting& setting, const RemovalOptions& options, SeamMarks& seam,
                   Progress& progress);

/// Removes darts, or their inner ends, where patches stay developable without them.
Index shorten_darts(const SeamSetting& setting, SeamMarks& seam, Progress& progress);

} // namespace devseg::plush
