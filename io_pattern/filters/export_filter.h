// The filter 'Pattern: Export', declared next to the writers: the core knows no files.
#pragma once

#include "devseg/declare/filter.h"

namespace devseg::exporting {

/// Writes output_file; its extension says the format: svg, pdf, dxf or html. Saving a mesh in one
/// of these formats takes the same parameters but for the file's name.
const declare::FilterDeclaration& export_filter();

/// All filters of the plugin: those of the core and the export.
const std::vector<declare::FilterDeclaration>& plugin_filters();

} // namespace devseg::exporting
