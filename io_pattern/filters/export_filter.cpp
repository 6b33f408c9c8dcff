#include "filters/export_filter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/declare/declare.h"
#include "devseg/filters/material_parameters.h"
#include "devseg/filters/table.h"
#include "filters/export_pattern.h"
#include "writers/file.h"

namespace devseg::exporting {

namespace {

constexpr const char* help =
    "Writes the pattern of any model with texture coordinates, true to scale: SVG and DXF for "
    "cutters and drawing programs, PDF for printers, and DXF for apparel CAD (ASTM D6673). An HTML "
    "page with the model, its pieces and the steps of the assembly.<br>"
    "A <b>preset</b> switches on what sewing, papercraft or a laser needs.";

using O = sheet::ExportOptions;

declare::Declare<O> with_scale(declare::Declare<O> filter) {
    return filter
        .real(&O::mm_per_unit, "Millimetres per unit",
              "Size on paper of one unit of the model, in millimetres: 1 for a model in "
              "millimetres, 1000 for one in metres. Above 0.")
        .real(&O::height_mm, "Height of the finished model (mm)",
              "Scales the pattern so that the finished model is this high, measured along the y "
              "axis, in millimetres. 0 = use the millimetres per unit.")
        .choice(&O::preset, "preset", "Preset", {"Plain", "Sewing", "Papercraft", "Laser"},
                "What to make; a preset switches on what the craft needs beside the options below. "
                "Plain adds nothing; Sewing: allowance, notches, grain lines; Papercraft: folds, "
                "tabs, seam numbers; Laser: cut lines alone, each once, with engraved names.")
        .real(&O::max_piece_mm, "Largest piece (mm)",
              "Longest side of a piece in millimetres; larger ones are cut. 0 = no limit.")
        .real(
            &O::curve_mm, "Curves within (mm)",
            "Outlines are written as smooth cubic curves of the same lengths that stay within this "
            "distance, in millimetres. They are splines in DXF for cutters and fine polylines in "
            "DXF for apparel CAD. 0 = straight lines between their points.")
        .real(&O::simplify_mm, "Simplify outlines (mm)",
              "Vertices of an outline are left out, on both sides of a seam at once, where that "
              "moves it by less than this, in millimetres. 0 keeps all vertices.");
}

declare::Declare<O> with_seams(declare::Declare<O> filter) {
    return filter
        .real(&O::seam_allowance_mm, {"seam_allowance_mm", 0.0, 1e4}, "Seam allowance (mm)",
              "Width of the allowance along the seams of each piece in millimetres. 0 = none (7 mm "
              "with the preset Sewing).")
        .real(&O::hem_allowance_mm, {"hem_allowance_mm", -1.0, 1e4}, "Hem allowance (mm)",
              "Width of the allowance along open borders of the model in millimetres. 0 = none, "
              "-1 = as along seams, and none around holes.")
        .real(&O::dart_allowance_mm, {"dart_allowance_mm", -1.0, 1e4}, "Dart allowance (mm)",
              "Width of the allowance along darts in millimetres. 0 = none, -1 = as along seams.")
        .real(&O::zip_allowance_mm, {"zip_allowance_mm", -1.0, 1e4}, "Zip allowance (mm)",
              "Width of the allowance along seams that get a zip in millimetres. -1 = as along "
              "seams.")
        .text(&O::zip_seams, "zip_seams", "Seams with a zip",
              "Numbers of the seams that get a zip, with commas between them, such as 3,7.")
        .choice(&O::corner_style, "corner_style", "Corners of the allowance",
                {"Miter", "Bevel", "Round"},
                "Convex corners of the cut line: Miter (pointed), Bevel (cut off), or Round. "
                "Concave ones are trimmed.")
        .boolean(&O::match_seams, "match_seams", "Match seams",
                 "Make both sides of each seam equally long, where they differ by more than "
                 "sewing bears.")
        .real(
            &O::alike_mm, "Make pieces alike within (mm)",
            "Pieces whose outlines differ by less than this, in millimetres, as they are or "
            "mirrored, all get the mean of their outlines. One template serves for them. 0 = none.")
        .real(&O::notch_spacing_mm, "Notch spacing (mm)",
              "Mean distance of the notches along a seam in millimetres. 0 = none (50 mm with the "
              "preset Sewing).")
        .choice(&O::notch_kind, "notch_kind", "Notches", {"Slit", "Triangle"},
                "Slit: a line inwards. Triangle: a small triangle to cut out, for thick cloth.")
        .boolean(&O::drill_marks, "drill_marks", "Drill marks",
                 "A cross where each dart ends inside of its piece.");
}

declare::Declare<O> with_folds(declare::Declare<O> filter) {
    return filter
        .boolean(&O::glue_tabs, "glue_tabs", "Glue tabs",
                 "A flap along one side of each seam. Flaps overlap no piece and no other flap: "
                 "they are made smaller or put on the other side.")
        .real(&O::tab_depth_mm, {"tab_depth_mm", 0.5, 1e3}, "Depth of glue tabs (mm)",
              "Depth of the flaps in millimetres, where there is room.")
        .choice(&O::tabs, "tabs", "Sides of glue tabs",
                {"Automatic", "One", "Both", "Alternating", "None"},
                "One: a flap on one side of each seam, wherever it fits best. Both: on both sides. "
                "Alternating: stretches of a seam take turns. None: no flaps, whatever the preset. "
                "Automatic: one where 'Glue tabs' or the preset asks for them.")
        .boolean(&O::border_tabs, "border_tabs", "Glue tabs on borders",
                 "Flaps along open borders of the model as well.")
        .boolean(
            &O::tab_shadows, "tab_shadows", "Shadows of glue tabs",
            "Outlines of the flaps on the pieces that they are glued to, where they lie within "
            "them.")
        .boolean(&O::fold_lines, "fold_lines", "Fold lines",
                 "Mountain folds (solid) and valley folds (dashed) where the surface bends, seen "
                 "from the outside.")
        .choice(&O::fold_marks, "fold_marks", "Marks of folds", {"Lines", "Outside", "None"},
                "Lines: along the whole fold. Outside: short strokes beside the outline where the "
                "fold ends, so that the piece stays clean. None: no marks.")
        .real(&O::perforation_mm, {"perforation_mm", 0.0, 1e3}, "Perforation (mm)",
              "Length in millimetres of the cuts that folds are made of, on a layer of their own "
              "for cutters. 0 = folds are lines.")
        .real(&O::perforation_gap_mm, {"perforation_gap_mm", 0.1, 1e3}, "Perforation gap (mm)",
              "What stays between two cuts of a perforation, in millimetres.")
        .real(&O::fold_angle, "Least fold angle (degrees)",
              "Edges that bend by less are no folds, in degrees.");
}

declare::Declare<O> with_paper(declare::Declare<O> filter) {
    return filter
        .text(
            &O::page, "page", "Page",
            "Paper to lay the pieces on: none (one sheet as large as it needs to be), a4, letter, "
            "a3, or a size. That is width x height in millimetres such as 600x400.")
        .real(&O::page_margin_mm, {"page_margin_mm", 0.0, 1e3}, "Page margin (mm)",
              "Border of each page that stays empty, in millimetres.")
        .boolean(&O::tiling, "tiling", "Tiling",
                 "Pieces larger than a page go on several pages that are glued together. Off: "
                 "they are refused.")
        .boolean(&O::fit_page, "fit_page", "Fit pieces on pages",
                 "Pieces that do not fit on a page are cut until they do, along folds where that "
                 "is short enough.")
        .boolean(&O::cover, "cover", "Cover and overview",
                 "PDF only: pages with the model and the numbers of its pieces, the list of seams, "
                 "and how the pages lie.")
        .boolean(&O::labels, "labels", "Piece names",
                 "Write its name (P01, P02, ...) into each piece, on a layer of its own that a "
                 "cutter can leave out.")
        .boolean(&O::edge_numbers, "edge_numbers", "Seam numbers",
                 "Write the number of each seam next to both of its sides.")
        .boolean(
            &O::grain_line, "grain_line", "Grain line",
            "Draw an arrow along the threads of the cloth into each piece. Without pages, pieces "
            "that are laid out anew have it upright; on pages it turns with its piece.")
        .boolean(
            &O::mirror, "mirror", "Mirror",
            "Draw each sheet as seen from its back, which is the inside of the model: mountain "
            "folds become valley folds.")
        .choice(&O::dxf_kind, "dxf_kind", "Kind of DXF", {"Automatic", "Cutter", "Apparel"},
                "Cutter: for cutters and drawing programs; Apparel: for apparel CAD (ASTM D6673). "
                "Automatic takes Apparel with the preset Sewing and Cutter otherwise.");
}

declare::Declare<O> with_print(declare::Declare<O> filter) {
    return filter
        .choice(&O::texture, "texture", "Texture on the pieces", {"None", "Automatic"},
                "What the model looks like is printed on the pieces of SVG, PDF and PNG files, or "
                "nothing (None). Automatic: its textures, else the colours of its faces, else "
                "those of its vertices. Tabs go on with the colours beside them.")
        .real(&O::bleed_mm, {"bleed_mm", 0.0, sheet::widest_bleed}, "Bleed (mm)",
              "How far the texture is printed beyond the cut lines, in millimetres.")
        .boolean(&O::registration_marks, "registration_marks", "Registration marks",
                 "Marks in the corners of each sheet, on a layer of their own, by which a cutter "
                 "finds what was printed.");
}

declare::Declare<O> with_files(declare::Declare<O> filter) {
    return filter
        .choice(
            &O::group, "group", "Groups of an SVG", {"Layer", "Piece"},
            "Layer: a layer for each operation. Piece: a group for each piece, with its outline, "
            "folds, marks and texts on layers inside it, so that they move together.")
        .choice(&O::text, "text", "Texts of an SVG", {"Text", "Paths"},
                "Text: as text. Paths: the outlines of the letters, for programs that drop texts.")
        .boolean(&O::frame, "frame", "Frame",
                 "SVG and DXF for cutters: a frame around the drawing, or around each page.")
        .boolean(&O::scale_check, "scale_check", "Scale check",
                 "SVG and DXF for cutters: squares to check the scale with, one on each page.");
}

declare::Declare<O> with_guide(declare::Declare<O> filter) {
    return filter
        .boolean(&O::step_numbers, "step_numbers", "Step numbers",
                 "Write the step of the assembly that does it behind the number of each seam: "
                 "12 (3) is seam 12, done in step 3.")
        .real(&O::sewing_mm_per_minute, {"sewing_mm_per_minute", 1.0, 1e6},
              "Sewing rate (mm per minute)",
              "Seam that is sewn in a minute, pinning included, in millimetres; for the time "
              "that the cover tells.")
        .real(&O::stuffing_g_per_litre, {"stuffing_g_per_litre", 0.0, 1e5},
              "Stuffing (g per litre)", "Mass of the stuffing, in the unit gram per litre.");
}

declare::Declare<O> with_cloth(declare::Declare<O> filter) {
    return filters::with_grain(filters::with_material(filter))
        .real(
            &O::kerf_mm, {"kerf_mm", -1.0, 100.0}, "Kerf (mm)",
            "Width that the cut burns away, in millimetres: outlines move outwards and holes "
            "inwards by half of it. With -1 it is that of the material with the preset Laser, else "
            "0.")
        .real(
            &O::fabric_width_mm, {"fabric_width_mm", 0.0, 1e5}, "Width of the cloth (mm)",
            "Lays all pieces on a roll of cloth of this width in millimetres, as short as it can. "
            "That is a marker, in SVG, PDF or DXF for cutters. 0 = no marker.")
        .real(&O::selvedge_mm, {"selvedge_mm", 0.0, 1e4}, "Selvedge (mm)",
              "Width at each side of the cloth that no piece lies on, in millimetres.")
        .boolean(
            &O::fold, "fold", "Folded cloth",
            "The cloth is folded along its length. Pieces and their mirror images are cut at once. "
            "Pieces that are their own mirror images lie along the fold.")
        .boolean(&O::nap, "nap", "Nap",
                 "All pieces lie the same way round, as pile and prints want it. Materials with a "
                 "nap do so by themselves.")
        .integer(&O::copies, {"copies", 1.0, 1e4}, "Copies",
                 "How many times the whole pattern lies on the cloth, a number.")
        .real(&O::piece_gap_mm, {"piece_gap_mm", 0.0, 1e3}, "Gap on the cloth (mm)",
              "Least distance of two pieces on the cloth in millimetres.")
        .text(&O::material_names, "material_names", "Names of materials",
              "Names of the materials in material_id, in the order of their numbers, with commas "
              "between them. Each has a cloth of its own on a marker. Empty: their numbers.")
        .text(
            &O::sizes, "sizes", "Sizes",
            "Heights of the finished model in millimetres, such as 200,250,300. All sizes lie over "
            "each other in colours of their own, with the numbers of the largest. They replace "
            "height_mm. Empty: the one size.")
        .choice(&O::effort, "effort", "Effort", {"Fast", "Normal", "Best"},
                "How long a short layout on the cloth is looked for: Fast takes a third of "
                "Normal, Best four times as long.");
}

// The assembly and what it needs, as numbers: pieces, seams and steps in their order.
declare::ResultValues guide_values(const PatternFile& file) {
    const assembly::Assembly& plan = file.assembly;
    const auto piece_of = [](std::size_t side) {
        return [side](const pattern::Seam& seam) { return seam.sides[side].piece; };
    };
    const auto itself = [](auto value) { return value; };
    using assembly::AssemblyStep;
    using assembly::Opening;
    return {{"piece_section", declare::column(plan.section, itself)},
            {"seam_first_piece", declare::column(file.seam_list, piece_of(0))},
            {"seam_second_piece", declare::column(file.seam_list, piece_of(1))},
            {"seam_step", declare::column(plan.seam_step, itself)},
            {"step_kind", declare::column(plan.steps, &AssemblyStep::kind)},
            {"step_section", declare::column(plan.steps, &AssemblyStep::section)},
            {"opening_seam",
             declare::column(plan.openings, [](const Opening& o) { return o.seam + 1; })},
            {"opening_from_mm", declare::column(plan.openings, &Opening::from)},
            {"opening_to_mm", declare::column(plan.openings, &Opening::to)},
            {"material_mm2", file.needs.material_mm2},
            {"seams_mm", file.needs.seam_mm},
            {"hems_mm", file.needs.hem_mm},
            {"sewing_minutes", file.needs.minutes},
            {"stuffing_litres", 1e-6 * file.needs.stuffing_mm3},
            {"stuffing_g", file.needs.stuffing_g},
            {"paper_sheets_number", file.needs.sheets_of_paper}};
}

// How the material is strained in each piece, and the cloth of a marker.
declare::ResultValues cloth_values(const PatternFile& file) {
    using Strain = pattern::ClothStrain;
    using Strip = sheet::FabricStrip;
    double length = 0.0;
    double covered = 0.0;
    double cloth = 0.0;
    int single = 0;
    for (const Strip& strip : file.fabrics) {
        length += strip.length;
        covered += strip.covered;
        cloth += strip.use > 0.0 ? strip.covered / strip.use : 0.0;
        single += static_cast<int>(strip.single_layer_pieces);
    }
    const auto above = std::count_if(file.cloth.begin(), file.cloth.end(),
                                     [](const Strain& strain) { return !strain.is_within; });
    return {{"piece_strain_along", declare::column(file.cloth, &Strain::along)},
            {"piece_strain_along_95", declare::column(file.cloth, &Strain::along_95)},
            {"piece_strain_across", declare::column(file.cloth, &Strain::across)},
            {"piece_strain_across_95", declare::column(file.cloth, &Strain::across_95)},
            {"piece_limit_use", declare::column(file.cloth, &Strain::use_99)},
            {"piece_worst_use", declare::column(file.cloth, &Strain::worst_use)},
            {"piece_worst_x_mm",
             declare::column(file.cloth, [](const Strain& s) { return s.worst_place.x(); })},
            {"piece_worst_y_mm",
             declare::column(file.cloth, [](const Strain& s) { return s.worst_place.y(); })},
            {"pieces_above_limits_number", static_cast<int>(above)},
            {"seam_ease_mm",
             declare::column(file.seam_list,
                             [](const pattern::Seam& seam) { return std::abs(seam.mismatch()); })},
            {"piece_fabric", declare::column(file.piece_fabric, [](Index k) { return k; })},
            {"fabric_area_mm2", declare::column(file.needs.fabric_mm2, [](double a) { return a; })},
            {"fabric_lengths_mm", declare::column(file.fabrics, &Strip::length)},
            {"fabric_uses", declare::column(file.fabrics, &Strip::use)},
            {"fabric_length_mm", length},
            {"fabric_use", cloth > 0.0 ? covered / cloth : 0.0},
            {"single_layer_pieces_number", single}};
}

declare::FilterOutput run_export(const declare::FilterInput& input,
                                 const sheet::ExportOptions& options, Progress& progress) {
    const surface::Look look{input.mesh, input.uv_before, input.page_before, input.textures,
                             input.corner_color};
    PatternFile file =
        make_pattern_file(input.mesh, *input.uv, input.material, look, options, progress);
    declare::FilterOutput output;
    output.notes = std::move(file.notes);
    output.values = {{"pieces_number", file.pieces},
                     {"seams_number", file.seams},
                     {"unnumbered_seams_number", file.unnumbered_seams},
                     {"unnamed_pieces_number", file.unnamed_pieces},
                     {"untabbed_seams_number", file.untabbed_seams},
                     {"sheets_number", file.sheets},
                     {"pages_number", file.pages}};
    for (const auto& values : {guide_values(file), cloth_values(file)})
        output.values.insert(output.values.end(), values.begin(), values.end());
    output.save = [path = options.output_file, bytes = std::move(file.bytes),
                   pages = std::move(file.page_bytes)] {
        for (std::size_t i = 0; i < pages.size(); ++i)
            writers::save_file(page_file(path, i, pages.size()), pages[i]);
        if (pages.empty())
            writers::save_file(path, bytes);
    };
    return output;
}

declare::Declare<O> with_results(declare::Declare<O> filter) {
    return filter.result("pieces_number", "pieces in the file")
        .result("seams_number", "seams, darts among them")
        .result("unnumbered_seams_number", "seams without room for the number that they "
                                           "should have on the pieces")
        .result("unnamed_pieces_number", "pieces without room for the name that they should "
                                         "have")
        .result("untabbed_seams_number", "seams without room for the glue tab that they should "
                                         "have")
        .result("sheets_number", "sheets that the pieces lie on")
        .result("pages_number", "pages of a PDF, cover included, or files of a .png; 0 for other "
                                "formats")
        .result("piece_section", "section that each piece is made in, counted from 0")
        .result("seam_first_piece", "for each seam the piece of its first side, from 0")
        .result("seam_second_piece", "the same of its second side")
        .result("seam_step", "step of the assembly that does each seam, from 1")
        .result("step_kind", "of each step: 1 darts, 2 joins a piece, 3 a piece with itself, "
                             "4 attaches a section, 5 closes a solid")
        .result("step_section", "section that each step works on")
        .result("opening_seam", "number of the seam that each opening lies on")
        .result("opening_from_mm", "where each opening begins, in mm from the seam's start")
        .result("opening_to_mm", "where it ends")
        .result("material_mm2", "area inside all cut lines in mm²")
        .result("seams_mm", "length of all seams in mm")
        .result("hems_mm", "length of all hems in mm")
        .result("sewing_minutes", "time to sew them")
        .result("stuffing_litres", "volume of the closed solids in litres")
        .result("stuffing_g", "mass of the stuffing in grams")
        .result("paper_sheets_number", "pages of the pattern alone; 0 without a page size")
        .result("piece_strain_along", "of each piece, where there is a material: largest "
                                      "strain along the grain on the model, 0.05 = 5 %")
        .result("piece_strain_along_95", "what 95 % of the area keeps")
        .result("piece_strain_across", "the largest across the grain")
        .result("piece_strain_across_95", "what 95 % of the area keeps")
        .result("piece_limit_use", "strain over what the material bears in its direction, on "
                                   "99 % of the area; within the limits up to 1")
        .result("piece_worst_use", "the same of the worst face; within the limits up to 2")
        .result("piece_worst_x_mm", "where that is in the layout of the pattern, in mm")
        .result("piece_worst_y_mm", "the same upwards")
        .result("pieces_above_limits_number", "pieces that strain the material too much")
        .result("seam_ease_mm", "of each seam, how much longer one side is, to be gathered")
        .result("piece_fabric", "which of the model's materials each piece is cut from, from 0")
        .result("fabric_area_mm2", "where there are several: area inside the cut lines of each")
        .result("fabric_lengths_mm", "length of the cloth of each of them on a marker")
        .result("fabric_uses", "share of each that pieces cover")
        .result("fabric_length_mm", "length of all cloths of a marker; 0 = no marker")
        .result("fabric_use", "share of the cloth between selvedges that pieces cover")
        .result("single_layer_pieces_number", "pieces cut from one layer of folded cloth");
}

} // namespace

const declare::FilterDeclaration& export_filter() {
    static const declare::FilterDeclaration filter = [] {
        declare::Declare<O> declared("Pattern: Export", "export_pattern",
                                     declare::FilterCategory::texture, help);
        declared.file(&O::output_file, "output_file", "File", "pattern.svg",
                      "File to write; its extension says the format: .svg, .pdf, .dxf, .html or "
                      ".png, a file for each page.");
        for (const auto add : {with_scale, with_seams, with_folds, with_paper, with_print,
                               with_files, with_guide, with_cloth, with_results})
            declared = add(std::move(declared));
        return declared.needs_uv().shows_outside().takes_surface().runs(run_export);
    }();
    return filter;
}

const std::vector<declare::FilterDeclaration>& plugin_filters() {
    static const std::vector<declare::FilterDeclaration> table = [] {
        std::vector<declare::FilterDeclaration> all = filters::filter_table();
        all.push_back(export_filter());
        return all;
    }();
    return table;
}

} // namespace devseg::exporting
