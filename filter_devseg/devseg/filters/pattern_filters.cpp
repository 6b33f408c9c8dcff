#include <algorithm>
#include <cmath>
#include <numeric>

#include "devseg/declare/declare.h"
#include "devseg/filters/material_parameters.h"
#include "devseg/filters/sheet_layout.h"
#include "devseg/pattern/cloth_strain.h"
#include "devseg/pattern/inside.h"
#include "devseg/pattern/match.h"
#include "devseg/pattern/optimize.h"
#include "devseg/pattern/pieces.h"
#include "devseg/plane/overlap.h"

namespace devseg::filters {

using namespace declare;

namespace {

constexpr const char* pieces_help =
    "Lays the pattern of a model with texture coordinates out as a flat mesh in millimetres, on a "
    "new layer: every chart at true scale where it lies on the sheet, seen from outside the model. "
    "Pieces that are larger than allowed are split, and pieces that lie on others get a place of "
    "their own.<br>"
    "Faces are coloured by strain: red where the material is longer on paper than on the model, "
    "blue where it is shorter, white where it keeps its length. The face quality is the strain "
    "(0.05 = 5 %). With a material, colour and quality tell the share of what it bears in that "
    "direction: red where it is stretched on the model, blue where it is compressed, in full "
    "colour at its limit and darker above. The face attribute <b>piece_id</b> the number of the "
    "piece from 0, and <b>source_face</b> the number of the face on the model.";

constexpr const char* measures_help =
    "Measures the pattern of a model with texture coordinates, whoever made them: pieces and their "
    "sizes, seams and how far their two sides differ, notches, and the strain of the material. "
    "Charts, darts and slits are read from the texture coordinates. Nothing is changed; the values "
    "are returned to scripts and written to the log.<br>"
    "Lengths are those on paper, in millimetres, after outlines are simplified and seams matched. "
    "Pieces and seams are listed in the order of their numbers in the drawing.";

constexpr const char* optimize_help =
    "Makes flat charts fit for sewing, whoever made them. Parts of a chart that lie on other parts "
    "of it are cut off, and small charts are joined to a neighbour where both together are nearly "
    "developable and lie flat without overlap. Darts that hardly open in the plane are "
    "glued again, from the tip on, as far as they stay closed.<br>"
    "Charts, darts and slits are read from the texture coordinates; the new ones are written to "
    "<b>chart_id</b> and <b>seam_edges</b> as well. Charts keep their places and sizes unless some "
    "were cut off, joined, lay on each other or were at other scales: then all are packed anew.<br>"
    "See:<br><i>Dan Julius, Vladislav Kraevoy, Alla Sheffer</i><br>"
    "<b>\"D-Charts: Quasi-Developable Mesh Segmentation\"</b><br>"
    "Computer Graphics Forum 24(3) (Eurographics), 2005, doi:10.1111/j.1467-8659.2005.00883.x";

struct LayerOptions : pattern::PatternOptions {
    double strain_range = 0.05; // strain that is drawn in full colour
};

template <class O>
Declare<O> with_scale(Declare<O> filter) {
    return filter
        .real(&O::mm_per_unit, "Millimetres per unit",
              "Size on paper of one unit of the model, in millimetres: 1 for a model in "
              "millimetres, 1000 for one in metres.")
        .real(&O::height_mm, "Height of the finished model (mm)",
              "Scales the pattern so that the finished model is this high, measured along the y "
              "axis, in millimetres. 0 = use the millimetres per unit.")
        .real(&O::max_piece_mm, "Largest piece (mm)",
              "Longest side of a piece in millimetres; larger ones are cut across their long "
              "direction, along edges of the mesh or straight through its faces. 0 = no limit.");
}

template <class O>
Declare<O> with_seams(Declare<O> filter) {
    return filter
        .real(&O::simplify_mm, "Simplify outlines (mm)",
              "Vertices of an outline are left out, on both sides of a seam at once, where that "
              "moves it by less than this, in millimetres. On pieces below 100 mm it is less, in "
              "proportion to their size. 0 keeps all vertices.")
        .boolean(&O::match_seams, "match_seams", "Match seams",
                 "Make both sides of each seam equally long, where they differ by more than sewing "
                 "bears. The angles of the outlines change as little as possible.")
        .real(&O::notch_spacing_mm, "Notch spacing (mm)",
              "Mean distance of the notches along a seam, in millimetres. 0 = no notches.")
        .real(&O::alike_mm, "Make pieces alike within (mm)",
              "Pieces whose outlines differ by less than this, in millimetres, as they are or "
              "mirrored, all get the mean of their outlines. It is 3 % of their size at most. So "
              "does a piece that is so near to its own mirror image. 0 = none.")
        .real(&O::pair_tolerance_mm, "Tolerance for equal pieces (mm)",
              "Pieces have the same shape if their outlines, turned and moved onto each other, "
              "differ by less than this, in millimetres. And by less than a hundredth of their "
              "size.");
}

std::uint8_t faded(double share) {
    return static_cast<std::uint8_t>(std::lround(255.0 * (1.0 - std::clamp(share, 0.0, 1.0))));
}

// Signed strain, or the use of limits, of each face: what its quality and colour are made from.
std::vector<double> face_values(const pattern::Pattern& pattern, double mm) {
    if (pattern.material)
        return pattern::limit_uses(pattern, mm);
    std::vector<double> values;
    for (const pattern::FaceStrain& own :
         pattern::measure_strain(pattern.mesh, pattern.corner_place, 1.0 / mm))
        values.push_back(own.extension >= own.compression ? own.extension : -own.compression);
    return values;
}

// Positive values are red and negative ones blue: full at 1 or −1, and half as bright from 2 on.
Color strain_color(double value) {
    const std::uint8_t fade = faded(std::abs(value));
    const double above = std::clamp(std::abs(value) - 1.0, 0.0, 1.0);
    const auto full = static_cast<std::uint8_t>(std::lround(255.0 - 127.0 * above));
    return value >= 0.0 ? Color{full, fade, fade} : Color{fade, fade, full};
}

// The faces of all pieces where they lie on the sheet; vertices are shared within a piece.
LayerMesh lay_out_faces(const FilterInput& input, const pattern::Pattern& pattern,
                        const std::vector<double>& values, double full_value) {
    const Mesh& mesh = pattern.mesh;
    LayerMesh layer;
    layer.name = "pattern pieces";
    std::vector<int> piece_id;
    std::vector<int> source_face;
    const atlas::ChartMap charts =
        atlas::make_chart_map(mesh, pattern.face_piece, pattern.seam, false);
    for (const atlas::ChartSurface& surface : atlas::extract_charts(mesh, charts)) {
        const Index p = pattern.face_piece[surface.face.front()];
        if (p < 0)
            continue; // charts too small to be cut out
        const Index first = static_cast<Index>(layer.geometry.points.size());
        layer.geometry.points.resize(at(first) + surface.vertex.size());
        for (const Face f : surface.all_faces()) {
            const Index source = surface.face[f];
            Triangle corners{};
            for (Index k = 0; k < 3; ++k) {
                corners[k] = first + surface.faces[f][k];
                const Vec2& position = pattern.corner_place[3 * source + k];
                layer.geometry.points[corners[k]] = Vec3(position.x(), position.y(), 0.0);
            }
            if (pattern.pieces[p].place.scale.x() < 0.0)
                std::swap(corners[1], corners[2]); // turned over: faces upwards again
            layer.geometry.faces.push_back(corners);
            const double share = values[source] / full_value;
            // Above the strain in full colour there is no limit to be told.
            layer.face_color.push_back(
                strain_color(pattern.material ? share : std::clamp(share, -1.0, 1.0)));
            layer.face_quality.push_back(values[source]);
            piece_id.push_back(p);
            source_face.push_back(input.source_face[pattern.source_face[source]]);
        }
    }
    layer.face_attributes = {{"piece_id", std::move(piece_id)},
                             {"source_face", std::move(source_face)}};
    return layer;
}

FilterOutput run_pieces(const FilterInput& input, const LayerOptions& options, Progress& progress) {
    const pattern::Pattern pattern =
        pattern::make_pattern(input.mesh, *input.uv, options, progress);
    FilterOutput output;
    output.notes = pattern.notes;
    const double mm = pattern.mm_per_unit * input.mesh.unit_length;
    output.layer = lay_out_faces(input, pattern, face_values(pattern, mm),
                                 pattern.material ? 1.0 : options.strain_range);
    output.values = {{"pieces_number", static_cast<int>(pattern.pieces.size())},
                     {"width_mm", pattern.width},
                     {"height_mm", pattern.height}};
    return output;
}

double largest(const std::vector<double>& values) {
    return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

double total(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

using Piece = pattern::PatternPiece;
using pattern::Seam;

double grain_angle(const Piece& piece) {
    return (180.0 / pi) * std::atan2(piece.grain_direction.y(), piece.grain_direction.x());
}

ResultValues measure_pieces(const pattern::Pattern& pattern) {
    const std::vector<Piece>& pieces = pattern.pieces;
    const auto areas = column(pieces, &Piece::area);
    const auto lengths = column(pieces, &Piece::long_side);
    const auto extensions = column(pieces, [](const Piece& p) { return p.strain.extension; });
    const auto compressions = column(pieces, [](const Piece& p) { return p.strain.compression; });
    const auto shapes =
        std::count_if(pieces.begin(), pieces.end(), [](const Piece& p) { return p.quantity > 0; });
    const auto folds = column(pieces, [](const Piece& p) { return p.folds.size(); });
    const auto pairs =
        column(pieces, [](const Piece& p) { return std::min(p.quantity, p.mirrored_quantity); });
    return {
        {"pieces_number", static_cast<int>(pieces.size())},
        {"shapes_number", static_cast<int>(shapes)},
        {"mirrored_pairs_number", static_cast<int>(total(pairs))},
        {"folds_number", static_cast<int>(total(folds))},
        {"width_mm", pattern.width},
        {"height_mm", pattern.height},
        {"area_mm2", total(areas)},
        {"largest_piece_mm", largest(lengths)},
        {"max_extension", largest(extensions)},
        {"max_compression", largest(compressions)},
        {"piece_area_mm2", areas},
        {"piece_length_mm", lengths},
        {"piece_width_mm", column(pieces, &Piece::short_side)},
        {"piece_extension", extensions},
        {"piece_compression", compressions},
        {"piece_mean_strain", column(pieces, [](const Piece& p) { return p.strain.mean; })},
        {"piece_area_change", column(pieces, [](const Piece& p) { return p.strain.area_change; })},
        {"piece_grain_angle", column(pieces, grain_angle)},
        {"piece_strain_along", column(pieces, [](const Piece& p) { return p.cloth.along; })},
        {"piece_strain_across", column(pieces, [](const Piece& p) { return p.cloth.across; })},
        {"piece_shape", column(pieces, &Piece::model)}};
}

ResultValues measure_seams(const pattern::Pattern& pattern) {
    const std::vector<Seam>& seams = pattern.seams;
    const auto mismatches = column(seams, [](const Seam& s) { return std::abs(s.mismatch()); });
    const auto darts =
        std::count_if(seams.begin(), seams.end(), [](const Seam& s) { return s.is_dart; });
    const auto apart = std::count_if(seams.begin(), seams.end(), [](const Seam& s) {
        return !pattern::sides_agree(s.sides[0].length, s.sides[1].length);
    });
    const auto notches = column(seams, [](const Seam& s) { return s.sides[0].notches.size(); });
    return {{"seams_number", static_cast<int>(seams.size())},
            {"darts_number", static_cast<int>(darts)},
            {"notches_number", static_cast<int>(total(notches))},
            {"hem_length_mm", pattern.hem_length},
            {"mismatched_seams_number", static_cast<int>(apart)},
            {"max_seam_mismatch_mm", largest(mismatches)},
            {"max_seam_mismatch_percent",
             largest(column(seams, [](const Seam& s) { return std::abs(s.mismatch_percent()); }))},
            {"seam_length_mm",
             column(seams,
                    [](const Seam& s) { return 0.5 * (s.sides[0].length + s.sides[1].length); })},
            {"seam_mismatch_mm", column(seams, &Seam::mismatch)}};
}

FilterOutput run_measures(const FilterInput& input, const pattern::PatternOptions& options,
                          Progress& progress) {
    const pattern::Pattern pattern =
        pattern::make_pattern(input.mesh, *input.uv, options, progress);
    FilterOutput output;
    output.notes = pattern.notes;
    output.values = measure_pieces(pattern);
    for (auto& value : measure_seams(pattern))
        output.values.push_back(std::move(value));
    return output;
}

bool any_overlap(const CornerUv& uv) {
    const std::vector<std::uint8_t> overlaps = plane::find_overlapping_faces(uv);
    return std::find(overlaps.begin(), overlaps.end(), 1) != overlaps.end();
}

bool lies_in_unit_square(const CornerUv& uv) {
    return std::all_of(uv.begin(), uv.end(),
                       [](const Vec2& p) { return p.minCoeff() >= 0.0 && p.maxCoeff() <= 1.0; });
}

FilterOutput run_optimize(const FilterInput& input, const pattern::OptimizeOptions& options,
                          Progress& progress) {
    const Mesh& mesh = input.mesh;
    FilterOutput output;
    CornerUv uv = *input.uv;
    auto removing = progress.part("removing overlaps", 0.2);
    pattern::FlatLayout layout = pattern::read_layout(mesh, uv);
    const bool is_stacked = options.remove_overlaps && any_overlap(uv);
    if (is_stacked)
        pattern::remove_overlaps(mesh, layout, removing);
    auto joining = progress.part("joining small charts", 0.4);
    if (options.reattach_gussets)
        pattern::reattach_gussets(mesh, options, layout, joining);
    auto packing = progress.part("packing charts", 0.3);
    if (is_stacked || layout.reattached > 0 || !layout.is_as_given) {
        const double side = lies_in_unit_square(uv) ? 1.0 : 0.0;
        SheetLayout sheet = lay_out(mesh, layout.flat, packing_with(options.effort), side, packing);
        note_unsettled(sheet, output);
        uv = std::move(sheet.uv);
    }
    const auto gluing = progress.part("gluing darts", 0.1);
    pattern::GluedDarts glued =
        pattern::glue_darts(mesh, layout.charts, uv, options.max_dart_angle * degrees);
    output.values = {
        {"charts_number", glued.charts.count},
        {"overlap_cuts_number", layout.overlap_cuts},
        {"reattached_charts_number", layout.reattached},
        {"glued_darts_number", glued.darts},
        {"glued_edges_number", glued.edges},
    };
    output.charts = std::move(glued.charts);
    output.uv = std::move(glued.uv);
    return output;
}

FilterDeclaration optimize() {
    using O = pattern::OptimizeOptions;
    return Declare<O>("Pattern: Optimize for Fabrication",
                      "apply_texcoord_pattern_optimization_per_wedge", FilterCategory::texture,
                      optimize_help)
        .boolean(&O::remove_overlaps, "remove_overlaps", "Remove overlaps",
                 "Cut off the parts of a chart that lie on other parts of it.")
        .boolean(&O::reattach_gussets, "reattach_gussets", "Reattach small charts",
                 "Join small charts, such as those cut off, to a neighbour where that is nearly "
                 "developable and lies flat without overlap.")
        .real(&O::max_gusset_area, {"max_gusset_area", 0.0, 1.0}, "Largest small chart",
              "Charts are small below this share of the model's area: 0.02 = 2 %.")
        .real(&O::merge_threshold, {"merge_threshold", 0.0, 4.0}, "Merge threshold",
              "Largest mean fitting error of a small chart's faces with the conic proxy of both "
              "charts together. No unit, from 0 (exactly developable) to 4 (anything).")
        .real(&O::max_dart_angle, {"max_dart_angle", 0.0, 180.0}, "Narrowest dart (degrees)",
              "Darts that open by less, in degrees, are glued again from their tips on. 0 = none.")
        .choice(&O::effort, "effort", "Effort of packing", effort_names(), effort_help)
        .needs_uv()
        .writes(writes_charts | writes_uv)
        .result("charts_number", "charts afterwards")
        .result("overlap_cuts_number", "cuts between parts of a chart that lay on each other")
        .result("reattached_charts_number", "small charts that were joined to a neighbour")
        .result("glued_darts_number", "darts that became shorter or vanished")
        .result("glued_edges_number", "mesh edges along which they were glued")
        .runs(run_optimize);
}

FilterDeclaration pieces() {
    using O = LayerOptions;
    return with_material(
               with_scale(Declare<O>("Pattern: Generate Pieces", "generate_pattern_pieces",
                                     FilterCategory::texture, pieces_help)))
        .real(&O::strain_range, {"strain_range", 1e-6, 10.0}, "Strain in full colour",
              "Strain from which on a face is drawn in full colour, as a share of the length: "
              "0.05 = 5 %. With a material its limits are.")
        .needs_uv()
        .shows_outside()
        .writes(writes_layer)
        .result("pieces_number", "pieces on the new layer")
        .result("width_mm", "width of the layout in mm")
        .result("height_mm", "height of the layout in mm")
        .runs(run_pieces);
}

FilterDeclaration measures() {
    using O = pattern::PatternOptions;
    return with_grain(with_material(with_seams(
                          with_scale(Declare<O>("Pattern: Measure", "get_pattern_measures",
                                                FilterCategory::measure, measures_help)))))
        .needs_uv()
        .shows_outside()
        .result("pieces_number", "pieces")
        .result("shapes_number", "different pieces, mirror images not counted")
        .result("mirrored_pairs_number", "pairs of a piece and its mirror image")
        .result("folds_number", "edges inside pieces that bend by more than 3 degrees")
        .result("width_mm", "width of the layout in mm")
        .result("height_mm", "height of the layout in mm")
        .result("area_mm2", "area of all pieces in mm²")
        .result("largest_piece_mm", "longest side of a piece in mm")
        .result("max_extension", "largest extension of a line between model and paper, 0.05 = 5 %")
        .result("max_compression", "largest compression, in the same way")
        .result("piece_area_mm2", "area of each piece in mm²")
        .result("piece_length_mm", "long side of the least box around each piece in mm")
        .result("piece_width_mm", "short side of this box in mm")
        .result("piece_extension", "largest extension in each piece")
        .result("piece_compression", "largest compression in each piece")
        .result("piece_mean_strain", "mean of the larger of the two over each piece")
        .result("piece_area_change", "area of each piece on paper over that on the model, less 1")
        .result("piece_grain_angle", "direction of the grain of each piece in degrees from x")
        .result("piece_strain_along",
                "with a material: largest strain of each piece along the grain")
        .result("piece_strain_across", "the same across it")
        .result("piece_shape", "for each piece the first piece of its shape, counted from 0")
        .result("seams_number", "seams, darts among them")
        .result("darts_number", "seams of a piece with itself that end at a tip")
        .result("notches_number", "pairs of notches")
        .result("hem_length_mm", "length of all outlines that are sewn to nothing in mm")
        .result("mismatched_seams_number", "seams whose sides differ by more than 0.2 % or 0.5 mm")
        .result("max_seam_mismatch_mm", "largest difference of a seam's sides in mm")
        .result("max_seam_mismatch_percent", "the same in percent of the seam's length")
        .result("seam_length_mm", "mean length of both sides of each seam in mm")
        .result("seam_mismatch_mm", "length of the first side less that of the second in mm")
        .runs(run_measures);
}

} // namespace

std::vector<FilterDeclaration> pattern_filters() {
    return {optimize(), pieces(), measures()};
}

} // namespace devseg::filters
