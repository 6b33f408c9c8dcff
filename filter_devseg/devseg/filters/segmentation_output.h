// What the segmentation filters leave on the mesh once they have a label for each face.
#pragma once

#include <vector>

#include "devseg/filters/filter.h"

namespace devseg {

/// Cuts the charts of `labels` to disks, with their tips where `cut_tips`; charts, colours and
/// `face_quality`, and the values charts_number, cut_length and seam_length.
FilterOutput segmentation_output(const FilterInput& input, const std::vector<Index>& labels,
                                 std::vector<double> face_quality, bool cut_tips,
                                 Progress& progress);

} // namespace devseg
