// The sheets of a pattern: which piece lies where, with allowances and tabs.
#pragma once

#include <optional>
#include <vector>

#include "devseg/base/progress.h"
#include "sheet/page_size.h"
#include "sheet/sheet_piece.h"
#include "sheet/texts.h"

namespace devseg::sheet {

/// One sheet, in its own coordinates. With pages, one page or several that are glued together.
struct PatternSheet {
    Vec2 size = Vec2::Zero(); // mm, margins included
    Index columns = 1;        // pages
    Index rows = 1;
};

struct PatternLayout {
    std::vector<SheetPiece> pieces; // in the order of the pattern, on their sheets
    std::vector<PatternSheet> sheets;
    LeftOut left_out; // texts for which there was no room
    std::optional<PageFormat> page;
    std::vector<std::string> notes; // for the user, one sentence each
};

/// Draws the pieces and lays them out. Without a page, the layout of the texture coordinates is
/// kept, unless allowances, tabs or shared edges make pieces touch: then, and on pages, they are
/// nested anew. `options` must be resolved. Throws InvalidParameter where a piece is larger than a
/// page that it may not leave, Cancelled.
PatternLayout lay_out_pattern(const pattern::Pattern& pattern, const ExportOptions& options,
                              Progress& progress);

} // namespace devseg::sheet
