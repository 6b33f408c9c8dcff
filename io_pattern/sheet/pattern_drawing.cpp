#include "sheet/pattern_drawing.h"

#include <algorithm>
#include <cmath>

#include "devseg/plane/plane.h"

namespace devseg::sheet {

namespace {

constexpr double margin = 10.0;    // mm, around check squares
constexpr double sheet_gap = 20.0; // mm, between two sheets
constexpr double check_text = 8.0; // mm, font size

// Importers that scale drawings do it unseen: a ruler on these squares shows it.
struct CheckSquare {
    const char* id;
    const char* text;
    double side; // mm
};
constexpr CheckSquare check_squares[] = {{"check-square", "50 mm", 50.0},
                                         {"check-square-inch", "2 inch", 50.8}};

// Three decimals (1 µm) are far below what a blade can follow. Small patterns, such as models in
// metres exported at 1 mm for a unit, need more. The grid is to be at most this share of the
// layout's size, and rounding may change the area of no piece by more than the second share
// (0.1 % is promised). Pieces below a millionth of the whole are measured against that millionth:
// nobody cuts them.
constexpr int usual_decimals = 3;
constexpr double grid_share = 1e-4;
constexpr double area_tolerance = 2e-4;
constexpr double negligible_piece = 1e-6;
// More digits than a double holds next to the margin say nothing.
constexpr int most_decimals = 15;

writers::DrawingPolyline rectangle(const Vec2& low, const Vec2& size) {
    return {{low, low + Vec2(size.x(), 0.0), low + size, low + Vec2(0.0, size.y())}, true};
}

// Area of a path whose points are rounded to the grid; as they are for a grid of 0.
double area_of(const writers::DrawingPath& path, double grid) {
    double twice = 0.0;
    for (const writers::DrawingPolyline& part : path.parts) {
        const auto rounded = [&](std::size_t i) {
            const Vec2& p = part.points[i];
            return grid > 0.0
                       ? Vec2(std::round(p.x() / grid) * grid, std::round(p.y() / grid) * grid)
                       : p;
        };
        const Vec2 first = rounded(0);
        for (std::size_t i = 2; i < part.points.size(); ++i) {
            twice += plane::cross(rounded(i - 1) - first, rounded(i) - first);
        }
    }
    return 0.5 * twice;
}

int decimals_for(const writers::DrawingLayer& cut) {
    double total = 0.0;
    Eigen::AlignedBox2d box;
    std::vector<double> areas;
    for (const writers::DrawingPath& path : cut.paths) {
        areas.push_back(path.parts.front().closed ? std::abs(area_of(path, 0.0)) : 0.0);
        total += areas.back();
        for (const writers::DrawingPolyline& part : path.parts)
            for (const Vec2& p : part.points)
                box.extend(p);
    }
    const auto holds = [&](double grid) {
        for (std::size_t i = 0; i < cut.paths.size(); ++i) {
            const double allowed = area_tolerance * std::max(areas[i], negligible_piece * total);
            if (areas[i] > 0.0 &&
                std::abs(std::abs(area_of(cut.paths[i], grid)) - areas[i]) > allowed)
                return false;
        }
        return true;
    };
    const double finest = grid_share * box.sizes().maxCoeff();
    int decimals = usual_decimals;
    while (decimals < most_decimals &&
           (std::pow(10.0, -decimals) > finest || !holds(std::pow(10.0, -decimals))))
        ++decimals;
    return decimals;
}

// The place of the sheets, and of the check squares in a strip beside them or below, whatever
// takes less paper.
struct Plan {
    std::vector<Vec2> sheets; // lower left corners
    std::vector<Vec2> squares;
    Vec2 size = Vec2::Zero();
};

Plan plan_drawing(const PatternLayout& layout) {
    const double strip = check_squares[1].side + margin;
    const double along = check_squares[0].side + check_squares[1].side + 3.0 * margin;
    Vec2 sheets(-sheet_gap, 0.0);
    for (const PatternSheet& sheet : layout.sheets)
        sheets =
            Vec2(sheets.x() + sheet_gap + sheet.size.x(), std::max(sheets.y(), sheet.size.y()));
    const Vec2 below(std::max(sheets.x(), along), sheets.y() + strip);
    const Vec2 beside(sheets.x() + strip, std::max(sheets.y(), along));
    const bool is_below = below.prod() <= beside.prod();
    Plan plan;
    plan.size = Vec2((is_below ? below : beside).array().ceil());
    double x = 0.0;
    for (const PatternSheet& sheet : layout.sheets) {
        plan.sheets.emplace_back(x, is_below ? std::ceil(strip) : 0.0);
        x += sheet.size.x() + sheet_gap;
    }
    const double step = check_squares[0].side + margin;
    const Vec2 first = is_below ? Vec2::Constant(margin) : Vec2(sheets.x(), margin);
    plan.squares = {first, first + (is_below ? Vec2(step, 0.0) : Vec2(0.0, step))};
    return plan;
}

// One path, whose parts are the lines.
void add_lines(const std::vector<std::vector<Vec2>>& lines, bool closed, const std::string& id,
               writers::DrawingLayer& layer) {
    writers::DrawingPath path{id, {}};
    for (const std::vector<Vec2>& line : lines)
        path.parts.push_back({line, closed});
    if (!path.parts.empty())
        layer.paths.push_back(std::move(path));
}

// The same for closed lines that may be curves.
void add_rings(const std::vector<std::vector<Vec2>>& rings,
               const std::vector<std::vector<pattern::OutlineCurve>>& curves, const std::string& id,
               writers::DrawingLayer& layer) {
    writers::DrawingPath path{id, {}};
    for (std::size_t i = 0; i < rings.size(); ++i) {
        path.parts.push_back({rings[i], true});
        if (i < curves.size())
            for (const pattern::OutlineCurve& curve : curves[i])
                path.parts.back().curves.push_back({curve.control, curve.is_line});
    }
    if (!path.parts.empty())
        layer.paths.push_back(std::move(path));
}

void add_notches(const SheetPiece& piece, writers::DrawingLayer& layer) {
    std::vector<std::vector<Vec2>> lines;
    for (const SheetNotch& notch : piece.notches)
        lines.push_back({notch.outer, notch.inner});
    add_lines(lines, false, piece.name + "-notch", layer);
}

writers::DrawingLayer scale_layer(const PatternLayout& layout, const Plan& plan) {
    writers::DrawingLayer layer{"scale", "Scale check", "#000000", {}, {}, {}};
    layer.paths.push_back({"frame", {rectangle(Vec2::Zero(), plan.size)}});
    if (layout.page)
        for (std::size_t i = 0; i < layout.sheets.size(); ++i)
            layer.paths.push_back({"sheet-" + std::to_string(i + 1),
                                   {rectangle(plan.sheets[i], layout.sheets[i].size)}});
    for (std::size_t i = 0; i < plan.squares.size(); ++i) {
        const CheckSquare& square = check_squares[i];
        const Vec2 side = Vec2::Constant(square.side);
        layer.paths.push_back({square.id, {rectangle(plan.squares[i], side)}});
        layer.texts.push_back({plan.squares[i] + 0.5 * side, check_text, square.text});
    }
    return layer;
}

} // namespace

writers::Drawing draw_sheets(const PatternLayout& layout, const ExportOptions& options) {
    const Plan plan = plan_drawing(layout);
    const bool laser = options.preset == PatternPreset::laser;
    writers::DrawingLayer cut{"cut", "Cut", "#ff0000", {}, {}, {}};
    writers::DrawingLayer mountain{"mountain", "Fold mountain", "#0000ff", {}, {}, {}};
    writers::DrawingLayer valley{"valley", "Fold valley", "#00aa00", {3.0, 1.5}, {}, {}};
    writers::DrawingLayer sew{"sew", "Sew line", "#00a000", {3.0, 1.5}, {}, {}};
    writers::DrawingLayer notch{"notch", "Notches", "#ff00ff", {}, {}, {}};
    writers::DrawingLayer grain{"grain", "Grain line", "#000000", {}, {}, {}};
    writers::DrawingLayer numbers{"numbers", "Seam numbers", "#000000", {}, {}, {}};
    writers::DrawingLayer text{"text", "Text", "#000000", {}, {}, {}};
    writers::DrawingLayer engrave{"engrave", "Engrave", "#0000ff", {}, {}, {}};
    for (SheetPiece piece : layout.pieces) {
        piece.move({1.0, 0.0, plan.sheets[piece.sheet]});
        add_rings(piece.cut, piece.cut_curves, piece.name + "-cut", cut);
        add_lines(piece.slits, false, piece.name + "-slit", piece.has_allowance() ? sew : cut);
        add_rings(piece.sew, piece.sew_curves, piece.name + "-sew", sew);
        add_lines(piece.mountains, false, piece.name + "-mountain", mountain);
        add_lines(piece.valleys, false, piece.name + "-valley", valley);
        add_lines(piece.grain, false, piece.name + "-grain", grain);
        add_notches(piece, notch);
        add_lines(piece.leaders, false, piece.name + "-leader", laser ? engrave : numbers);
        for (const auto& [texts, layer] : {std::pair(&piece.names, laser ? &engrave : &text),
                                           std::pair(&piece.numbers, laser ? &engrave : &numbers)})
            layer->texts.insert(layer->texts.end(), texts->begin(), texts->end());
    }
    writers::Drawing drawing;
    drawing.width = plan.size.x();
    drawing.height = plan.size.y();
    drawing.decimals = decimals_for(cut);
    drawing.layers = {cut,     mountain, valley,  sew,
                      notch,   grain,    engrave, scale_layer(layout, plan),
                      numbers, text};
    for (std::size_t i = 0; i < layout.sheets.size() && layout.page; ++i)
        drawing.sheets.push_back({plan.sheets[i], layout.sheets[i].size});
    return drawing;
}

} // namespace devseg::sheet
