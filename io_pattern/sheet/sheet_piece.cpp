#include "sheet/sheet_piece.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/base/errors.h"
#include "devseg/declare/segmentation_output.h"
#include "devseg/pattern/curves.h"
#include "devseg/pattern/inside.h"
#include "devseg/plane/plane.h"
#include "sheet/marks.h"
#include "sheet/segment_grid.h"
#include "writers/text.h"

namespace devseg::sheet {

namespace {

// The sides of a cut that lie on each other up to this are one line: a knife would follow both.
constexpr double one_line = 0.1; // mm

// What the outer line must keep of its area where sides become one line: a piece as thin as that is
// no slit.
constexpr double kept_area = 0.9;

// Points along curves lie so close that nobody sees the difference.
constexpr double sagitta = 0.002; // mm

// Both hold for pieces of this length and above, and in proportion for smaller ones.
constexpr double full_length = 100.0; // mm

double for_size(double tolerance, const pattern::PatternPiece& piece) {
    return tolerance * std::min(1.0, piece.box.sizes().maxCoeff() / full_length);
}

// Half of a triangle's width at the edge, of its depth.
constexpr double notch_slope = 0.5;

// Of cut lines beside the sew line: what turns by more is a corner.
constexpr double corner_turn = 0.35; // radians, 20 degrees

// Points of an outline, some of them replaced by others.
struct Outline {
    std::vector<Vec2> points;
    std::vector<std::uint8_t> skipped;       // #points
    std::vector<std::vector<Vec2>> inserted; // #points, behind the point

    explicit Outline(const pattern::PiecePath& path)
        : points(path.points), skipped(points.size(), 0), inserted(points.size()) {}

    std::size_t at_index(Index i) const { return at(i) % points.size(); }
    std::vector<Vec2> ring() const {
        std::vector<Vec2> result;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (skipped[i] == 0)
                result.push_back(points[i]);
            result.insert(result.end(), inserted[i].begin(), inserted[i].end());
        }
        return result;
    }
    // Holes whose sides became one line.
    bool has_vanished() const { return ring().size() < 3; }
    // The ring with the curves of the path, as far as nothing of them was replaced.
    std::vector<pattern::OutlineCurve> curves(const pattern::PiecePath& path) const {
        std::vector<pattern::OutlineCurve> result;
        std::vector<Vec2> start;
        const auto line_to = [&](const Vec2& p) {
            if (start.empty()) {
                start = {p, p};
            } else if (p != start[1]) {
                const Vec2 third = (p - start[1]) / 3.0;
                result.emplace_back();
                result.back().control = {start[1], start[1] + third, p - third, p};
                start[1] = p;
            }
        };
        for (const pattern::OutlineCurve& curve : path.curves) {
            bool whole = skipped[at_index(curve.first)] == 0 &&
                         skipped[at_index(curve.first + curve.count)] == 0;
            for (Index i = curve.first; i < curve.first + curve.count; ++i)
                whole = whole && inserted[at_index(i)].empty() &&
                        (i == curve.first || skipped[at_index(i)] == 0);
            if (whole) {
                line_to(curve.control[0]);
                result.push_back(curve);
                start[1] = curve.control[3];
                continue;
            }
            for (Index i = curve.first; i < curve.first + curve.count; ++i) {
                if (skipped[at_index(i)] == 0)
                    line_to(points[at_index(i)]);
                for (const Vec2& p : inserted[at_index(i)])
                    line_to(p);
            }
        }
        if (!start.empty())
            line_to(start[0]);
        return result;
    }
};

// Index in the outline of point i of a side, counted from the seam's start.
Index side_point(const pattern::SeamSide& side, Index i) {
    return side.first + (side.reversed ? side.count - i : i);
}

// From where on the sides of the dart lie on each other up to the tip; the number of edges if they
// do nowhere.
Index mouth_of(const pattern::Seam& dart, const Outline& outline, double tolerance) {
    const auto point = [&](const pattern::SeamSide& side, Index i) {
        return outline.points[outline.at_index(side_point(side, i))];
    };
    Index mouth = dart.sides[0].count;
    while (mouth > 0 &&
           (point(dart.sides[0], mouth - 1) - point(dart.sides[1], mouth - 1)).norm() <= tolerance)
        --mouth;
    return mouth;
}

// A dart whose sides lie on each other up to its tip, or from some place on, is cut once.
void merge_slits(const pattern::Pattern& pattern, Index index, std::vector<Outline>& outlines,
                 std::vector<std::vector<Vec2>>& slits) {
    const pattern::PatternPiece& piece = pattern.pieces[index];
    for (const Index s : piece.seams()) {
        const pattern::Seam& seam = pattern.seams[at(s)];
        const pattern::SeamSide& a = seam.sides[0];
        const pattern::SeamSide& b = seam.sides[1];
        if (!seam.is_dart || a.piece != index || a.path != b.path || a.count != b.count)
            continue;
        Outline& outline = outlines[a.path];
        const Index mouth = mouth_of(seam, outline, for_size(one_line, piece));
        if (mouth == a.count)
            continue;
        std::vector<Vec2> slit;
        for (Index i = mouth; i <= a.count; ++i)
            slit.push_back(outline.points[outline.at_index(side_point(a, i))]);
        Outline merged = outline;
        for (Index i = mouth + 1; i <= a.count; ++i) {
            merged.skipped[outline.at_index(side_point(a, i))] = 1;
            merged.skipped[outline.at_index(side_point(b, i))] = 1;
        }
        merged.skipped[outline.at_index(side_point(b, mouth))] = 1;
        // Holes may vanish: a slit is all that there is of them. A piece does not: where its whole
        // border is one cut, the sheet is folded double, and stays open.
        if (a.path == 0 &&
            (merged.has_vanished() ||
             plane::signed_area(merged.ring()) < kept_area * plane::signed_area(outline.ring())))
            continue;
        outline = std::move(merged);
        slits.push_back(std::move(slit));
    }
}

// A tab continues its piece behind the other side of the seam: its base bends as the surface does
// along the seam, by the mean of its edges (radians).
double bend_at(const pattern::Pattern& pattern, const pattern::PiecePath& path,
               const GlueTab& tab) {
    double sum = 0.0;
    double length = 0.0;
    for (Index i = tab.first; i < tab.first + tab.count; ++i) {
        const std::size_t from = at(i) % path.points.size();
        const double edge =
            (path.points[(from + 1) % path.points.size()] - path.points[from]).norm();
        sum += edge * pattern::fold_angle_at(pattern.mesh, path.half_edge[from]);
        length += edge;
    }
    return length > 0.0 ? sum / length : 0.0;
}

// Strokes of this length outside of outlines mark where folds end.
constexpr double outside_mark = 2.5; // mm
constexpr double on_outline = 0.05;  // mm: nearer ends of folds lie on it

// The cuts of a perforation along a line, with a gap at either end.
void perforate(const std::vector<Vec2>& line, const ExportOptions& options, SheetPiece& result) {
    for (std::size_t i = 1; i < line.size(); ++i) {
        const Vec2 along = line[i] - line[i - 1];
        const double length = along.norm();
        const double pitch = options.perforation_mm + options.perforation_gap_mm;
        const double whole = std::floor((length - options.perforation_gap_mm) / pitch);
        const double number = std::max(1.0, whole);
        const double cut = std::min(options.perforation_mm, 0.5 * length);
        const double start = 0.5 * (length - number * pitch + options.perforation_gap_mm);
        for (double k = 0.0; k < number && length > 0.0; ++k) {
            const double from = whole < 1.0 ? 0.5 * (length - cut) : start + k * pitch;
            result.perforations.push_back(
                {line[i - 1] + from / length * along, line[i - 1] + (from + cut) / length * along});
        }
    }
}

void add_fold(std::vector<Vec2> line, bool is_mountain, const ExportOptions& options,
              SheetPiece& result) {
    if (options.perforation_mm > 0.0)
        perforate(line, options, result);
    else
        (is_mountain ? result.mountains : result.valleys).push_back(std::move(line));
}

void add_tabs(const pattern::Pattern& pattern, const std::vector<GlueTab>& tabs,
              const ExportOptions& options, std::vector<Outline>& outlines, SheetPiece& result) {
    const double least_fold = options.fold_angle * degrees;
    for (const GlueTab& tab : tabs) {
        Outline& outline = outlines[tab.path];
        std::vector<Vec2> base;
        for (Index i = tab.first; i <= tab.first + tab.count; ++i)
            base.push_back(outline.points[outline.at_index(i)]);
        const pattern::PiecePath& path = pattern.pieces[result.piece].path(tab.path);
        const double bend = tab.on_border ? pi : bend_at(pattern, path, tab);
        if (std::abs(bend) > least_fold && options.fold_marks == FoldMarks::lines)
            add_fold(std::move(base), bend > 0.0, options, result);
        for (Index i = tab.first + 1; i < tab.first + tab.count; ++i)
            outline.skipped[outline.at_index(i)] = 1;
        std::vector<Vec2>& flap = outline.inserted[outline.at_index(tab.first)];
        flap = {tab.corner[0]};
        if (tab.corner[1] != tab.corner[0])
            flap.push_back(tab.corner[1]);
    }
}

// Strokes that go on from the ends of a fold on the outline; on tabs as well.
void mark_outside(const pattern::PieceFold& fold, const std::vector<std::vector<Vec2>>& outlines,
                  const ExportOptions& options, SheetPiece& result) {
    const auto is_on_outline = [&](const Vec2& p) {
        for (const std::vector<Vec2>& ring : outlines)
            for (std::size_t i = 0; i < ring.size(); ++i)
                if (plane::distance(p, ring[i], ring[(i + 1) % ring.size()]) <= on_outline)
                    return true;
        return false;
    };
    const Vec2 along = (fold.to - fold.from).normalized();
    for (const auto& [end, out] : {std::pair(fold.from, Vec2(-along)), std::pair(fold.to, along)}) {
        const Vec2 tip = end + outside_mark * out;
        if (is_on_outline(end) && !plane::is_inside(outlines, end + 2.0 * on_outline * out) &&
            !plane::is_inside(outlines, tip))
            add_fold({end, tip}, fold.angle > 0.0, options, result);
    }
}

void add_folds(const pattern::PatternPiece& piece, const ExportOptions& options,
               SheetPiece& result) {
    if (options.fold_marks == FoldMarks::none)
        return;
    std::vector<std::vector<Vec2>> outlines;
    for (Index i = 0; i < piece.path_count(); ++i)
        outlines.push_back(piece.path(i).points);
    for (const pattern::PieceFold& fold : piece.folds) {
        if (!plane::is_inside(outlines, 0.5 * (fold.from + fold.to)))
            continue; // where outlines are simpler
        if (options.fold_marks == FoldMarks::outside)
            mark_outside(fold, outlines, options, result);
        else
            add_fold({fold.from, fold.to}, fold.angle > 0.0, options, result);
    }
}

// Lines that follow the curves.
std::vector<std::vector<Vec2>>
rings_of(const std::vector<std::vector<pattern::OutlineCurve>>& curves, double tolerance) {
    std::vector<std::vector<Vec2>> rings;
    for (const std::vector<pattern::OutlineCurve>& ring : curves)
        rings.push_back(pattern::flatten_curves(ring, tolerance));
    return rings;
}

// Cut and sew lines as curves.
void add_curves(const pattern::PatternPiece& piece, const std::vector<Outline>& outlines,
                const ExportOptions& options, SheetPiece& result) {
    std::vector<std::vector<pattern::OutlineCurve>> own;
    for (std::size_t i = 0; i < outlines.size(); ++i)
        if (!outlines[i].has_vanished())
            own.push_back(outlines[i].curves(piece.path(static_cast<Index>(i))));
    const double tolerance = for_size(sagitta, piece);
    if (!result.has_allowance()) {
        result.cut = rings_of(own, tolerance);
        result.cut_curves = std::move(own);
        return;
    }
    result.sew = rings_of(own, tolerance);
    result.sew_curves = std::move(own);
    for (const std::vector<Vec2>& ring : result.cut)
        result.cut_curves.push_back(pattern::fit_ring(ring, corner_turn, options.curve_mm));
    result.cut = rings_of(result.cut_curves, tolerance);
}

// What the cut burns away on the piece's side comes back.
void add_kerf(const ExportOptions& options, const pattern::PatternPiece& piece,
              SheetPiece& result) {
    result.cut = grown_rings(result.cut, 0.5 * options.kerf_mm);
    if (result.cut_curves.empty())
        return;
    result.cut_curves.clear();
    for (const std::vector<Vec2>& ring : result.cut)
        result.cut_curves.push_back(pattern::fit_ring(ring, corner_turn, options.curve_mm));
    result.cut = rings_of(result.cut_curves, for_size(sagitta, piece));
}

template <class Change>
void change_points(SheetPiece& piece, Change change) {
    for (auto* lines :
         {&piece.cut, &piece.sew, &piece.slits, &piece.mountains, &piece.valleys, &piece.grain,
          &piece.leaders, &piece.openings, &piece.perforations, &piece.shadows, &piece.drills})
        for (std::vector<Vec2>& line : *lines)
            for (Vec2& p : line)
                p = change(p);
    for (auto* rings : {&piece.cut_curves, &piece.sew_curves})
        for (std::vector<pattern::OutlineCurve>& ring : *rings)
            for (pattern::OutlineCurve& curve : ring)
                for (Vec2& p : curve.control)
                    p = change(p);
    for (SheetNotch& notch : piece.notches) {
        notch.outer = change(notch.outer);
        notch.inner = change(notch.inner);
    }
    for (Vec2& p : piece.grain_line)
        p = change(p);
    for (auto* texts : {&piece.names, &piece.numbers})
        for (writers::DrawingText& text : *texts)
            text.position = change(text.position);
}

} // namespace

std::vector<Vec2> SheetNotch::line(NotchKind kind) const {
    if (kind == NotchKind::slit)
        return {outer, inner};
    const Vec2 aside = notch_slope * plane::left_of(Vec2(inner - outer));
    return {outer - aside, inner, outer + aside};
}

Eigen::AlignedBox2d SheetPiece::box() const {
    Eigen::AlignedBox2d box;
    for (const std::vector<Vec2>& ring : cut)
        box.extend(plane::box_of(ring));
    return box;
}

void SheetPiece::move(const pack::Placement& placement) {
    change_points(*this, placement);
    pack::Placement& all = frame.placement;
    all.offset = placement(all.offset);
    const double cosine = placement.cosine * all.cosine - placement.sine * all.sine;
    all.sine = placement.sine * all.cosine + placement.cosine * all.sine;
    all.cosine = cosine;
}

void SheetPiece::mirror(double axis) {
    change_points(*this, [axis](const Vec2& p) { return Vec2(2.0 * axis - p.x(), p.y()); });
    for (auto* rings : {&cut, &sew})
        for (std::vector<Vec2>& ring : *rings)
            std::reverse(ring.begin(), ring.end());
    for (auto* rings : {&cut_curves, &sew_curves})
        for (std::vector<pattern::OutlineCurve>& ring : *rings) {
            std::reverse(ring.begin(), ring.end());
            for (pattern::OutlineCurve& curve : ring)
                std::reverse(curve.control.begin(), curve.control.end());
        }
    std::swap(mountains, valleys); // seen from the other side
    // Turned over first, the piece comes to the same place by the opposite turn.
    frame.mirrored = true;
    frame.placement.sine = -frame.placement.sine;
    frame.placement.offset.x() = 2.0 * axis - frame.placement.offset.x();
}

std::vector<declare::Color> piece_colors(const pattern::Pattern& pattern) {
    atlas::ChartMap charts;
    charts.count = static_cast<Index>(pattern.pieces.size()) + 1;
    for (const Index piece : pattern.face_piece)
        charts.chart.push_back(piece < 0 ? charts.count - 1 : piece);
    return declare::chart_colors(pattern.mesh, charts);
}

SheetPiece compose_piece(const pattern::Pattern& pattern, Index index, const GlueTabs& tabs,
                         const ExportOptions& options) {
    const pattern::PatternPiece& piece = pattern.pieces[index];
    SheetPiece result;
    result.piece = index;
    result.name = piece.name;
    std::vector<Outline> outlines;
    for (Index i = 0; i < piece.path_count(); ++i)
        outlines.emplace_back(piece.path(i));
    merge_slits(pattern, index, outlines, result.slits);
    if (!tabs.tabs.empty())
        add_tabs(pattern, tabs.tabs[at(index)], options, outlines, result);
    for (const TabShadow& shadow : tabs.shadows)
        if (shadow.piece == index && options.tab_shadows)
            result.shadows.push_back(shadow.line);
    for (const Outline& outline : outlines)
        if (!outline.has_vanished())
            result.cut.push_back(outline.ring());
    const AllowanceWidths allowance = options.allowance();
    if (allowance.largest() > 0.0) {
        result.sew = std::move(result.cut);
        result.cut = add_allowance(piece, allowance, options.corner_style);
        if (result.cut.empty())
            throw InvalidParameter("seam_allowance_mm: expected pieces large enough for an "
                                   "allowance, found one of " +
                                   writers::number_text(piece.box.sizes().maxCoeff(), 6) +
                                   " mm; check the scale (mm_per_unit, height_mm)");
    }
    if (options.curve_mm > 0.0)
        add_curves(piece, outlines, options, result);
    if (options.kerf_mm > 0.0)
        add_kerf(options, piece, result);
    if (options.fold_lines)
        add_folds(piece, options, result);
    add_notches(pattern, options, result);
    if (options.drill_marks)
        add_drills(pattern, result);
    if (options.grain_line)
        add_grain(piece, result);
    return result;
}

} // namespace devseg::sheet
