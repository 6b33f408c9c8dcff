// What the segmentation filters leave on the mesh once they have a label for each face.
#pragma once

#include <vector>

#include "devseg/atlas/disks.h"
#include "devseg/declare/filter.h"

namespace devseg::declare {

/// Cuts the charts of `labels` to disks; charts, colours and `face_quality`, and the values
/// charts_number, cut_length and seam_length.
FilterOutput segmentation_output(const FilterInput& input, const std::vector<Index>& labels,
                                 std::vector<double> face_quality, const atlas::DiskOptions& cuts,
                                 Progress& progress);

} // namespace devseg::declare
