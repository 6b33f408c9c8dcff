// Taking seams away that are not needed, by trial flattenings.
#pragma once

#include "devseg/plush/seam_network.h"
#include "devseg/progress.h"

namespace devseg {

struct RemovalOptions {
    double max_area_change = 0.15;
    // What goes first: the mean weight of a segment's edges [the paper], times a power of its length
    // and of the smaller patch's size.
    double length_power = 0.0;
    double size_power = 0.0;
    double defect_power = 0.0;
};

/// What seams are judged by.
struct SeamSetting {
    const Mesh& mesh;
    const SeamMarks& hard;             // 3 #F or empty
    const std::vector<double>& weight; // 3 #F
    const std::vector<Index>& mirror;  // #V: the vertex on the other side, or empty
    const std::vector<double>& defect; // #V: |angle defect|
};

/// Removes segments, the least natural first, together with their mirror images, as long as all
/// patches that grow stay developable; seams that end inside a patch are darts. Returns the number
/// of trials.
Index remove_seams(const SeamSetting& setting, const RemovalOptions& options, SeamMarks& seam,
                   Progress& progress);

} // namespace devseg
