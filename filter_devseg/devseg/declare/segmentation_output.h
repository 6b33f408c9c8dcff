// What segmentation filters leave on the mesh, with one colour for each chart.
#pragma once

#include <optional>
#include <vector>

#include "devseg/atlas/disks.h"
#include "devseg/declare/filter.h"

namespace devseg::declare {

/// Colours of the charts (#charts). The largest charts choose first, each the palette's first
/// colour that no neighbour has: the same charts get the same colours, whatever their numbers.
std::vector<Color> chart_colors(const Mesh& mesh, const atlas::ChartMap& charts);

/// The same, spread to the faces (#F).
std::vector<Color> face_chart_colors(const Mesh& mesh, const atlas::ChartMap& charts);

/// The same beside charts that have colours (`given`, #charts).
std::vector<Color> face_chart_colors(const Mesh& mesh, const atlas::ChartMap& charts,
                                     const std::vector<std::optional<Color>>& given);

/// Selects the faces of the charts that need a look (#charts); where none does, the selection
/// stays.
void select_charts(const std::vector<std::uint8_t>& charts, FilterOutput& output);

/// Charts with their colours, and these values. `quality`: #F.
FilterOutput chart_output(const Mesh& mesh, atlas::ChartMap charts, std::vector<double> quality,
                          ResultValues values);

/// The same of labels (#F), whose charts are cut to disks, with the values charts_number,
/// cut_length and seam_length.
FilterOutput segmentation_output(const FilterInput& input, const std::vector<Index>& labels,
                                 std::vector<double> quality, const atlas::DiskOptions& cuts,
                                 Progress& progress);

} // namespace devseg::declare
