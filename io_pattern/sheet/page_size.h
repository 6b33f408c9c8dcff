// The paper that a pattern is printed on.
#pragma once

#include <optional>
#include <string>

#include "devseg/mesh/mesh.h"
#include "sheet/export_options.h"

namespace devseg::sheet {

constexpr double tile_overlap = 10.0; // mm that two pages of one sheet share, to be glued

struct PageFormat {
    Vec2 size = Vec2::Zero(); // mm
    double margin = 0.0;      // mm on all sides

    Vec2 printable() const { return size - Vec2::Constant(2.0 * margin); }
    /// From one page of a sheet to the next.
    Vec2 step() const { return printable() - Vec2::Constant(tile_overlap); }
};

/// none (no value), a4, letter, a3 or WxH, such as 600x400. Throws InvalidParameter for others and
/// for pages that their margins leave no room on.
std::optional<PageFormat> page_format(const ExportOptions& options);

} // namespace devseg::sheet
