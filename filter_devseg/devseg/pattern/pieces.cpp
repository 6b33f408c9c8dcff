#include "devseg/pattern/pieces.h"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <utility>

#include "devseg/base/errors.h"
#include "devseg/pattern/alike.h"
#include "devseg/pattern/bends.h"
#include "devseg/pattern/chart_areas.h"
#include "devseg/pattern/cloth_strain.h"
#include "devseg/pattern/corners.h"
#include "devseg/pattern/curves.h"
#include "devseg/pattern/inside.h"
#include "devseg/pattern/match.h"
#include "devseg/pattern/outlines.h"
#include "devseg/pattern/same_pieces.h"
#include "devseg/pattern/seams.h"
#include "devseg/pattern/shapes.h"
#include "devseg/pattern/split.h"
#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// Beyond these sizes positions in double precision no longer hold a piece's shape next to the
// margins of the sheet (10 mm), or 0.1 mm on the sheet.
constexpr double smallest_layout_mm = 1e-10;
constexpr double largest_layout_mm = 1e12;

// A layout whose pieces have come to lie on each other is drawn out by these shares, one after the
// other: nested pieces part by a few gaps of the packing (0.2 %), or not at all.
constexpr double drawn_out[] = {0.003, 0.004, 0.007, 0.01, 0.02};
// And once more, for a gap between them.
constexpr double drawn_gap = 0.01;

std::string number(double value) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << value;
    return text.str();
}

// Millimetres for one internal unit of the mesh.
double paper_scale(const Mesh& mesh, const PatternOptions& options) {
    if (options.height_mm == 0.0)
        return options.mm_per_unit * mesh.unit_length;
    Vec3 low = mesh.points.front();
    Vec3 high = low;
    for (const Vec3& p : mesh.points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const double extent = high.y() - low.y();
    if (!(extent > no_extent * (high - low).norm()))
        throw InvalidParameter("height_mm: expected a model with a height, found one without "
                               "extent along y; give mm_per_unit instead");
    return options.height_mm / extent;
}

void check_coordinates(const CornerUv& uv) {
    std::vector<Index> bad;
    for (std::size_t f = 0; 3 * f < uv.size(); ++f)
        if (!uv[3 * f].allFinite() || !uv[3 * f + 1].allFinite() || !uv[3 * f + 2].allFinite())
            bad.push_back(static_cast<Index>(f));
    if (!bad.empty())
        throw InvalidMesh("expected finite texture coordinates, found NaN or infinite ones on " +
                              std::to_string(bad.size()) + (bad.size() == 1 ? " face" : " faces") +
                              flatten_first,
                          bad);
    if (std::all_of(uv.begin(), uv.end(), [&](const Vec2& p) { return p == uv.front(); }))
        throw InvalidMesh(std::string("expected texture coordinates that lay the charts out, "
                                      "found all of them at one point") +
                          flatten_first);
}

// All names equally long, so that they sort: P01 … P12, or P001 … P120.
void number_pieces(std::vector<PatternPiece>& pieces) {
    const std::size_t digits = std::max<std::size_t>(2, std::to_string(pieces.size()).size());
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const std::string ordinal = std::to_string(i + 1);
        pieces[i].name = 'P' + std::string(digits - ordinal.size(), '0') + ordinal;
    }
}

void note_mismatches(Pattern& pattern) {
    const Seam* worst = nullptr;
    Index count = 0;
    for (const Seam& seam : pattern.seams) {
        if (sides_agree(seam.sides[0].length, seam.sides[1].length))
            continue;
        ++count;
        if (worst == nullptr || std::abs(seam.mismatch()) > std::abs(worst->mismatch()))
            worst = &seam;
    }
    if (worst != nullptr)
        pattern.notes.push_back("the sides of " + std::to_string(count) + " of " +
                                std::to_string(pattern.seams.size()) +
                                " seams differ by more than 0.2 % or 0.5 mm, " + "most on seam " +
                                worst->label + " by " +
                                number(std::round(1000.0 * std::abs(worst->mismatch())) / 1000.0) +
                                " mm ('Charts: Flatten' with the method LPFB keeps their lengths)");
}

// The layout's lower left corner comes to the origin.
void place_on_sheet(Pattern& pattern, const char* scale_name) {
    const Eigen::AlignedBox2d box = bounding_box(pattern.pieces);
    pattern.width = box.sizes().x();
    pattern.height = box.sizes().y();
    const double size = std::max(pattern.width, pattern.height);
    if (!(size >= smallest_layout_mm) || !(size <= largest_layout_mm))
        throw InvalidParameter(std::string(scale_name) +
                               ": expected a scale at which the pieces take " +
                               number(smallest_layout_mm) + " to " + number(largest_layout_mm) +
                               " mm, found " + number(size) + " mm");
    for (PatternPiece& piece : pattern.pieces)
        move_piece(piece, -box.min());
}

void place_label(PatternPiece& piece) {
    const LabelPoint point = find_label_point(piece.rings());
    piece.label_position = point.position;
    piece.label_radius = point.radius;
}

// The charts at one scale, with those that are too large split.
struct Layout {
    SplitLayout split;
    ChartAreas areas;
    bool is_as_given = true; // no chart had another scale
};

Layout read_layout(const Mesh& mesh, const CornerUv& uv, const PatternOptions& options, double mm,
                   const Progress& progress) {
    const atlas::ChartMap charts = atlas::charts_from_uv(mesh, uv);
    const atlas::EvenLayout even = atlas::even_layout(mesh, charts, uv);
    Layout layout{whole_layout(mesh, even.uv, charts),
                  measure_charts(mesh, even.uv, charts, even.scale), even.is_as_given};
    check_charts(charts, layout.areas);
    if (options.max_piece_mm > 0.0 || options.max_width_mm > 0.0) {
        SplitLayout& split = layout.split;
        const auto limit = [&](double most) {
            return most > 0.0 ? most / (even.scale * mm) : infinite;
        };
        split_large_charts({limit(options.max_piece_mm), limit(options.max_width_mm)}, split,
                           progress);
        layout.areas = measure_charts(split.mesh, split.uv, split.charts, even.scale);
        check_charts(split.charts, layout.areas);
    }
    return layout;
}

// Chains that end at corners, with simple outlines and sides of equal length.
std::vector<Chain> refine_outlines(const Mesh& mesh, const std::vector<std::uint8_t>& cut,
                                   const PatternOptions& options, double mm, Pattern& pattern,
                                   Progress& progress) {
    std::vector<PatternPiece>& pieces = pattern.pieces;
    std::vector<Chain> chains =
        cut_at_corners(pieces, find_chains(mesh, pieces, cut), options.corner_angle * degrees);
    measure_surface(mesh, pieces, mm, chains);
    if (options.simplify_mm > 0.0)
        simplify_outlines(pieces, chains, options.simplify_mm);
    progress.check();
    if (options.match_seams)
        match_sides(pieces, chains, progress);
    if (options.alike_mm > 0.0) {
        for (PatternPiece& piece : pieces)
            measure_outlines(piece);
        if (make_alike(pieces, options.alike_mm, progress) > 0 && options.match_seams)
            match_sides(pieces, chains, progress);
    }
    drop_empty_edges(pieces, chains);
    return chains;
}

// The chart of each piece that lies on another one before it.
std::vector<Index> overlapping_charts(std::vector<PatternPiece>& pieces) {
    for (PatternPiece& piece : pieces) {
        measure_outlines(piece);
        place_label(piece);
    }
    std::vector<Index> charts;
    for (const std::size_t i : overlapping_pieces(pieces))
        charts.push_back(pieces[i].chart);
    return charts;
}

// Draws the layout out as little as it takes to part pieces that have come to lie on each other.
// Returns those that still do.
std::vector<std::size_t> draw_out(std::vector<PatternPiece>& pieces) {
    const auto draw = [&](double share) {
        for (PatternPiece& piece : pieces)
            move_piece(piece, share * piece.box.center());
        return overlapping_pieces(pieces);
    };
    std::vector<std::size_t> others = overlapping_pieces(pieces);
    for (std::size_t i = 0; i < std::size(drawn_out) && !others.empty(); ++i)
        others = draw(drawn_out[i]);
    return others.empty() ? draw(drawn_gap) : others;
}

// Pieces that overlap, and the parts of split ones, get places of their own. `drawn`: the pieces as
// the texture coordinates have them. Sides that were made equally long may have pushed outlines
// into each other, which needs no word.
void separate(const std::vector<std::uint8_t>& is_part, std::vector<PatternPiece> drawn,
              Pattern& pattern) {
    std::vector<std::size_t> moved;
    std::vector<PatternPiece>& pieces = pattern.pieces;
    for (std::size_t i = 0; i < pieces.size(); ++i)
        if (is_part[pieces[i].chart] != 0)
            moved.push_back(i);
    move_above(pieces, moved);
    std::vector<std::size_t> others = overlapping_pieces(pieces);
    if (others.empty())
        return;
    const std::vector<Index> stacked = overlapping_charts(drawn);
    if (stacked.empty())
        others = draw_out(pieces);
    move_above(pieces, others);
    const auto count = std::count_if(others.begin(), others.end(), [&](std::size_t i) {
        return std::binary_search(stacked.begin(), stacked.end(), pieces[i].chart);
    });
    if (count > 0)
        pattern.notes.push_back(std::to_string(count) + " of " + std::to_string(pieces.size()) +
                                (count == 1 ? " pieces lies" : " pieces lie") +
                                " on others in the texture coordinates: moved above the layout");
}

// 1 for every chart that was cut off another one, or has another scale than it was given.
std::vector<std::uint8_t> find_parts(const Layout& layout) {
    const SplitLayout& split = layout.split;
    std::vector<std::uint8_t> is_part(at(split.charts.count), layout.is_as_given ? 0 : 1);
    for (std::size_t h = 0; h < split.cut.size(); ++h)
        if (split.cut[h] != 0)
            is_part[split.charts.chart[h / 3]] = 1;
    return is_part;
}

// Everything that is read off the finished outlines.
void describe_pieces(const Mesh& mesh, const CornerUv& uv, const atlas::ChartMap& charts,
                     const PatternOptions& options, double mm, Pattern& pattern,
                     Progress& progress) {
    const Buckets<Index> groups = atlas::group_faces(charts);
    const auto faces_of = [&](const PatternPiece& piece) {
        const Span<Index> faces = groups[piece.chart];
        return std::vector<Index>(faces.begin(), faces.end());
    };
    const double count = static_cast<double>(pattern.pieces.size());
    pattern.face_piece.assign(mesh.faces.size(), -1);
    pattern.corner_place.assign(3 * mesh.faces.size(), Vec2::Zero());
    for (std::size_t i = 0; i < pattern.pieces.size(); ++i) {
        const std::vector<Index> faces = faces_of(pattern.pieces[i]);
        const std::vector<Vec2> corners = place_corners(mesh, uv, faces, pattern.pieces[i]);
        for (std::size_t k = 0; k < faces.size(); ++k) {
            pattern.face_piece[faces[k]] = static_cast<Index>(i);
            for (std::size_t corner = 0; corner < 3; ++corner)
                pattern.corner_place[at(3 * faces[k]) + corner] = corners[3 * k + corner];
        }
        progress.update(0.5 * static_cast<double>(i) / count);
    }
    const std::vector<FaceStrain> strain = measure_strain(mesh, pattern.corner_place, 1.0 / mm);
    for (std::size_t i = 0; i < pattern.pieces.size(); ++i) {
        PatternPiece& piece = pattern.pieces[i];
        set_cloth(mesh, faces_of(piece), options, mm, pattern, piece);
        measure_inside(mesh, pattern.corner_place, faces_of(piece), charts.seam, strain,
                       options.fold_angle * degrees, mm, piece);
        progress.update(0.5 + 0.5 * static_cast<double>(i) / count);
    }
    find_same_pieces(pattern.pieces, options.pair_tolerance_mm, progress);
}

} // namespace

OptionRanges<PatternOptions> PatternOptions::ranges() {
    using O = PatternOptions;
    return {{&O::mm_per_unit, {"mm_per_unit", 1e-9, 1e9}},
            {&O::height_mm, {"height_mm", 0.0, 1e9}},
            {&O::max_piece_mm, {"max_piece_mm", 0.0, 1e9}},
            {&O::max_width_mm, {"max_width_mm", 0.0, 1e9}},
            {&O::simplify_mm, {"simplify_mm", 0.0, 1e6}},
            {&O::notch_spacing_mm, {"notch_spacing_mm", 0.0, 1e6}},
            {&O::alike_mm, {"alike_mm", 0.0, 1e3}},
            {&O::pair_tolerance_mm, {"pair_tolerance_mm", 0.0, 1e6}},
            {&O::curve_mm, {"curve_mm", 0.0, 1e3}},
            {&O::corner_angle, {"corner_angle", 0.0, 180.0}},
            {&O::fold_angle, {"fold_angle", 0.0, 180.0}},
            {&O::thickness_mm, {"thickness_mm", 0.0, 1e3}},
            {&O::bend_radius_mm, {"bend_radius_mm", -1.0, 1e4}},
            {&O::k_factor, {"k_factor", -1.0, 1.0}},
            {&O::grain_angle, {"grain_angle", -180.0, 180.0}}};
}

Pattern make_pattern(const Mesh& whole, const CornerUv& uv, const PatternOptions& options,
                     Progress& progress) {
    check_ranges(options);
    Pattern pattern;
    if (!options.material.empty())
        pattern.material = material::read_material(options.material);
    const double mm = paper_scale(whole, options);
    check_coordinates(uv);

    auto reading = progress.part("reading charts", 0.05);
    Layout layout = read_layout(whole, uv, options, mm, reading);
    SplitLayout& split = layout.split;
    const Mesh& mesh = split.mesh;

    auto tracing = progress.part("tracing outlines", 0.12);
    pattern.mm_per_unit = mm / mesh.unit_length;
    pattern.pieces = trace_pieces(mesh, split.uv, split.charts, layout.areas.worth_cutting(),
                                  layout.areas.scale * mm, tracing);
    std::vector<PatternPiece> drawn = pattern.pieces;
    auto refining = progress.part("refining outlines", 0.1);
    const std::vector<Chain> chains =
        refine_outlines(mesh, split.cut, options, mm, pattern, refining);
    if (const Bend bend = find_bend(options, pattern.material); bend.changes_lengths())
        compensate_bends(mesh, split.charts, split.uv, bend, options.fold_angle * degrees, pattern);

    const auto placing = progress.part("placing pieces", 0.13);
    for (PatternPiece& piece : pattern.pieces) {
        measure_outlines(piece);
        place_label(piece);
        placing.check();
    }
    separate(find_parts(layout), std::move(drawn), pattern);
    place_on_sheet(pattern, options.height_mm > 0.0 ? "height_mm" : "mm_per_unit");

    auto describing = progress.part("describing pieces", 0.6);
    number_pieces(pattern.pieces);
    set_seams(pattern, chains);
    set_notches(pattern, options.notch_spacing_mm);
    mark_corners(pattern.pieces, chains, options.corner_angle * degrees);
    if (options.curve_mm > 0.0)
        fit_curves(pattern.pieces, chains, options.curve_mm);
    describe_pieces(mesh, split.uv, split.charts, options, mm, pattern, describing);
    note_folds(pattern, layout.areas);
    if (!layout.is_as_given)
        pattern.notes.emplace_back(
            "the charts are not at one scale in the texture coordinates: each "
            "was brought to the scale of its own area on the model");
    note_mismatches(pattern);
    if (std::string note = cloth_note(pattern); !note.empty())
        pattern.notes.push_back(std::move(note));
    pattern.mesh = std::move(split.mesh);
    pattern.seam = std::move(split.charts.seam);
    pattern.source_face = std::move(split.source_face);
    return pattern;
}

} // namespace devseg::pattern
