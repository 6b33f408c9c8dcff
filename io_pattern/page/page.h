// Pattern → one HTML page that needs no network: the model in 3D, its pieces on their sheets, and
// the steps of the assembly, linked.
#pragma once

#include <string>

#include "devseg/base/progress.h"
#include "sheet/needs.h"
#include "sheet/sheet_drawing.h"

namespace devseg::page {

/// UTF-8. The page holds three.js, the drawing as SVG, and the model with 16 bits for a coordinate:
/// about 20 bytes for a face, beside 0.4 MB. Throws Cancelled.
std::string page_bytes(const pattern::Pattern& pattern, const sheet::PatternLayout& layout,
                       const sheet::ExportOptions& options, const std::string& title,
                       const Progress& progress);

} // namespace devseg::page
