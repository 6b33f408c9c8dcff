// The sheets of a pattern: which piece lies where, with allowances and tabs.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "devseg/assembly/assembly.h"
#include "devseg/base/progress.h"
#include "devseg/pack/pack.h"
#include "sheet/export_options.h"
#include "sheet/marks.h"
#include "sheet/sheet_piece.h"

namespace devseg::sheet {

constexpr double sheet_margin = 10.0; // mm, around pieces where no page says otherwise
constexpr double sheet_gap = 2.0 * sheet_margin;

// Distance of two pieces: a blade's width and some more, but not more than small patterns bear.
constexpr double piece_gap = 3.0; // mm
static_assert(widest_bleed <= piece_gap, "the print of a piece reaches no other one");

struct NestingOptions {
    double width = 0.0;      // mm
    double height = 0.0;     // mm; 0 = one sheet that is as high as it needs to be
    double gap = 0.0;        // mm, least distance of two pieces
    bool keep_grain = false; // grain lines upright; otherwise pieces are turned as they fit
};

struct Nesting {
    std::vector<pack::Placement>
        placements;           // one for each piece; the sheet's lower left is the origin
    std::vector<Index> sheet; // −1: larger than a sheet
    Index sheet_count = 0;
};

/// Piece by piece, the largest first, each at the lowest free place of the first sheet that has
/// one, then the leftmost, in the best of its four turns. On a grid of conservative images.
Nesting nest_pieces(const std::vector<const SheetPiece*>& pieces, const NestingOptions& options,
                    Progress& progress);

/// One sheet, in its own coordinates. With pages, one page or several that are glued together.
struct PatternSheet {
    Vec2 size = Vec2::Zero(); // mm, margins included
    Index columns = 1;        // pages
    Index rows = 1;
};

/// Where crosses are printed in the strips that pages share, on every page that shows them; from
/// the sheet's lower left corner. `page` is the format of the sheet's pages.
std::vector<Vec2> strip_crosses(const PatternSheet& sheet, const PageFormat& page);
constexpr double cross_arm = 2.5; // mm

/// A roll of cloth that all pieces lie on, or those of one of the model's materials.
struct FabricStrip {
    std::string material;
    double width = 0.0;    // mm, with both selvedges
    double selvedge = 0.0; // mm
    double length = 0.0;   // mm
    double covered = 0.0;  // mm², by pieces
    double use = 0.0;      // the same as a share of the cloth between the selvedges
    bool is_folded = false;
    Index single_layer_pieces = 0; // cut from the upper layer of folded cloth alone
};

/// All pieces in another size, where those of the layout lie; cut lines, slits and notches.
struct SizedPieces {
    double height = 0.0; // mm, of the finished model
    std::vector<SheetPiece> pieces;
};

struct PatternLayout {
    // In the order of the pattern, on their sheets. On a roll of cloth: what is cut of it, with
    // copies, and without what folded cloth gives of itself.
    std::vector<SheetPiece> pieces;
    std::vector<PatternSheet> sheets;
    assembly::Assembly assembly; // the order in which the pieces are put together
    LeftOut left_out;            // texts for which there was no room
    std::optional<PageFormat> page;
    std::vector<FabricStrip> fabrics; // of a marker: one for each sheet
    std::vector<SizedPieces> sizes;   // but the one of the layout
    Index seams_without_tab = 0;      // for lack of room, where tabs were asked for
    std::vector<Index> narrow;        // pieces too narrow to be glued, where tabs were asked for
};

/// Draws the pieces and lays them out. Without a page, the layout of the texture coordinates is
/// kept, unless allowances, tabs or shared edges make pieces touch: then, and on pages, they are
/// nested anew. `options` must be resolved. Throws InvalidParameter where a piece is larger than a
/// page that it may not leave, or wider than the roll of cloth, Cancelled.
PatternLayout lay_out_pattern(const pattern::Pattern& pattern, const ExportOptions& options,
                              Progress& progress);

/// What there was no room for, one sentence each for the user.
std::vector<std::string> layout_notes(const pattern::Pattern& pattern, const PatternLayout& layout);

} // namespace devseg::sheet
