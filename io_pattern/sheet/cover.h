// The cover of a pattern: pictures of the model with the numbers of its pieces, and how they are
// put together.
#pragma once

#include <string>
#include <vector>

#include "devseg/mesh/mesh.h"
#include "devseg/pattern/pattern.h"
#include "sheet/sheet_drawing.h"
#include "writers/drawing.h"

namespace devseg::sheet {

/// One page, and more where the list of pieces is long. Pages of the pattern's own size, or A4.
std::vector<writers::DocumentPage> cover_pages(const pattern::Pattern& pattern,
                                               const PatternLayout& layout,
                                               const std::vector<PrintedPage>& pages,
                                               const ExportOptions& options,
                                               const std::string& title);

} // namespace devseg::sheet
