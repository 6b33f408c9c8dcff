// The groups that make up the filter table, one source each.
#pragma once

#include <vector>

#include "devseg/declare/filter.h"

namespace devseg {

std::vector<FilterDeclaration> segmentation_filters();
std::vector<FilterDeclaration> t_flooding_filters();
std::vector<FilterDeclaration> papercraft_filters();
std::vector<FilterDeclaration> deformation_filters();
std::vector<FilterDeclaration> plush_filters();
std::vector<FilterDeclaration> baseline_filters();
std::vector<FilterDeclaration> flattening_filters();
std::vector<FilterDeclaration> pattern_filters();
std::vector<FilterDeclaration> sewn_preview_filters();
std::vector<FilterDeclaration> measure_filters();
std::vector<FilterDeclaration> circle_map_filters();

/// Charts of the mesh's attributes; without them, those of its texture coordinates; without those,
/// its connected components.
ChartMap find_charts(const FilterInput& input);

} // namespace devseg
