// Pattern → what the page's script reads: pieces with their faces, seams, steps, needs.
#pragma once

#include <QByteArray>

#include "devseg/base/progress.h"
#include "sheet/needs.h"
#include "sheet/sheet_drawing.h"

namespace devseg::page {

/// JSON. Points of the model are in millimetres within `box` ("low", "size"), 16 bits for each
/// coordinate; arrays of numbers are base64 of little-endian integers.
QByteArray model_data(const pattern::Pattern& pattern, const sheet::PatternLayout& layout,
                      const sheet::ExportOptions& options, const writers::Drawing& drawing,
                      const std::string& title, const Progress& progress);

} // namespace devseg::page
