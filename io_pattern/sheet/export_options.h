// How a pattern is to be drawn, and the paper that it is printed on.
#pragma once

#include <optional>
#include <string>

#include "devseg/assembly/assembly.h"
#include "devseg/mesh/mesh.h"
#include "devseg/pattern/pieces.h"
#include "sheet/allowance.h"
#include "sheet/tabs.h"

namespace devseg::sheet {

/// What a craft needs; options that are given count beside it.
enum class PatternPreset { plain, sewing, papercraft, laser };
enum class DxfKind { automatic, cutter, apparel };
/// Notches: a line from the edge of the cloth inwards, or a small triangle to cut out.
enum class NotchKind { slit, triangle };
/// What makes a group in an SVG: all of one operation, or all of one piece.
enum class Grouping { layer, piece };
/// How long layouts on cloth are looked for.
enum class Effort { fast, normal, best };
/// Texts of an SVG: as text, or as outlines of its letters.
enum class TextKind { text, paths };
/// What is printed on the pieces: nothing, or what the model's surface looks like.
enum class SurfacePrint { none, automatic };
/// Folds as lines, as short strokes outside of the outlines, where nobody sees them later, or not.
enum class FoldMarks { lines, outside, none };

struct ExportOptions : pattern::PatternOptions {
    ExportOptions() { notch_spacing_mm = 0.0; }

    std::string output_file;
    PatternPreset preset = PatternPreset::plain;
    double seam_allowance_mm = 0.0;
    double hem_allowance_mm = -1.0;  // along open borders; below 0: as along seams, holes none
    double dart_allowance_mm = -1.0; // along darts; below 0: as along seams
    double zip_allowance_mm = -1.0;  // along seams with a zip; below 0: as along seams
    std::string zip_seams;           // their numbers, with commas
    CornerStyle corner_style = CornerStyle::miter;
    bool glue_tabs = false;
    double tab_depth_mm = 5.0;
    TabSides tabs = TabSides::automatic;
    bool border_tabs = false; // tabs along open borders as well
    bool tab_shadows = false; // where they are glued, on the other piece
    bool fold_lines = false;
    FoldMarks fold_marks = FoldMarks::lines;
    double perforation_mm = 0.0; // length of the cuts that make a fold; 0: folds are drawn
    double perforation_gap_mm = 1.0;
    bool edge_numbers = false; // the number of each seam on both sides
    bool step_numbers = false; // behind each number, the step of the assembly that does the seam
    NotchKind notch_kind = NotchKind::slit;
    bool drill_marks = false; // where darts end
    bool grain_line = false;
    bool mirror = false;       // as seen from inside the model
    std::string page = "none"; // none, a4, letter, a3 or WxH in mm
    double page_margin_mm = 10.0;
    bool tiling = true;    // pieces larger than a page go on several
    bool fit_page = false; // pieces are cut until each fits on a page
    bool cover = true;     // PDF: picture of the model, list of the pieces, overview
    DxfKind dxf_kind = DxfKind::automatic;
    Grouping group = Grouping::layer;
    TextKind text = TextKind::text;
    bool frame = true;       // SVG, cutter DXF: around the drawing or its pages
    bool scale_check = true; // the same: squares to check the scale with

    SurfacePrint texture = SurfacePrint::none;
    double bleed_mm = 2.0;           // of the print, beyond the cut lines
    bool registration_marks = false; // that cutters find the print by

    double kerf_mm = -1.0; // width of the cut; below 0: of the material, with the preset Laser

    // A marker: all pieces on a roll of cloth, which replaces the pages.
    double fabric_width_mm = 0.0; // with both selvedges; 0 = none
    double selvedge_mm = 0.0;     // at each side, that no piece lies on
    bool fold = false;            // the cloth lies double, folded along its length
    bool nap = false;             // all pieces the same way round
    int copies = 1;               // of the whole pattern
    double piece_gap_mm = 3.0;    // between two pieces on the cloth
    Effort effort = Effort::normal;

    std::string material_names; // of the model's materials, with commas; empty: by their numbers
    std::string sizes;          // heights in mm, drawn over each other; empty: the one size

    double sewing_mm_per_minute = 100.0; // with pins and needles, at home
    double stuffing_g_per_litre = 30.0;  // polyester fibre, as firm as toys are

    /// Sewn, unless there are tabs to glue.
    assembly::Craft craft() const {
        return glue_tabs ? assembly::Craft::papercraft : assembly::Craft::sewing;
    }
    /// Whether the place that stays open is drawn: on patterns to sew.
    bool marks_openings() const {
        return preset == PatternPreset::sewing || allowance().largest() > 0.0;
    }
    /// What the print adds around each piece.
    double bleed() const { return texture == SurfacePrint::none ? 0.0 : bleed_mm; }
    bool is_marker() const { return fabric_width_mm > 0.0; }
    /// Throws InvalidParameter for zip_seams that are no numbers.
    AllowanceWidths allowance() const;
};

/// The options with all that the preset stands for. Throws InvalidParameter for values outside of
/// their range.
ExportOptions resolved(const ExportOptions& options);

constexpr double widest_bleed = 3.0; // mm: pieces on pages have this distance

constexpr double tile_overlap = 10.0; // mm that two pages of one sheet share, to be glued

struct PageFormat {
    Vec2 size = Vec2::Zero(); // mm
    double margin = 0.0;      // mm on all sides

    Vec2 printable() const { return size - Vec2::Constant(2.0 * margin); }
    /// From one page of a sheet to the next.
    Vec2 step() const { return printable() - Vec2::Constant(tile_overlap); }
};

/// The options with limits of the pieces' size, such that each fits on a page with its tabs or
/// allowance, where that is asked for. `options` must be resolved. Throws InvalidParameter without
/// a page.
ExportOptions limited_to_page(const ExportOptions& options);

/// none (no value), a4, letter, a3 or WxH, such as 600x400. Throws InvalidParameter for others and
/// for pages that their margins leave no room on.
std::optional<PageFormat> page_format(const ExportOptions& options);

} // namespace devseg::sheet
