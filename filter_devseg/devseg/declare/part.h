// Filters on a part of a mesh: on the selected faces alone, with seams or charts that stay.
#pragma once

#include <vector>

#include "devseg/declare/filter.h"

namespace devseg::declare {

/// `selected_only` and `keep`, where a filter takes them.
std::vector<Parameter> part_parameters(bool on_part, bool keeps);

/// Runs the filter on what `selected_only` and `keep` leave to it. What it sees then is a mesh of
/// its own, cut open along the border of the part and along the seams that stay: so no method needs
/// to know of them, and none can take them away. Its charts, coordinates and split faces are put
/// back into the whole mesh: new charts take numbers that no other face has, and new coordinates
/// lie beside the others at their scale. Throws InvalidMesh where nothing is selected, or has no
/// chart.
FilterOutput run_on_part(const FilterDeclaration& filter, const FilterInput& input,
                         ParameterValues values, Progress& progress);

} // namespace devseg::declare
