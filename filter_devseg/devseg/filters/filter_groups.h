// The groups that make up the filter table, one source each.
#pragma once

#include <vector>

#include "devseg/declare/filter.h"

namespace devseg::filters {

std::vector<declare::FilterDeclaration> segmentation_filters();
std::vector<declare::FilterDeclaration> t_flooding_filters();
std::vector<declare::FilterDeclaration> papercraft_filters();
std::vector<declare::FilterDeclaration> deformation_filters();
std::vector<declare::FilterDeclaration> plush_filters();
std::vector<declare::FilterDeclaration> baseline_filters();
std::vector<declare::FilterDeclaration> flattening_filters();
std::vector<declare::FilterDeclaration> pattern_filters();
std::vector<declare::FilterDeclaration> sewn_preview_filters();
std::vector<declare::FilterDeclaration> measure_filters();
std::vector<declare::FilterDeclaration> circle_map_filters();

/// Charts of the mesh's attributes; without them, those of its texture coordinates; without those,
/// its connected components.
atlas::ChartMap find_charts(const declare::FilterInput& input);

} // namespace devseg::filters
