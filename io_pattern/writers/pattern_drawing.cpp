#include "writers/pattern_drawing.h"

#include <algorithm>
#include <cmath>

namespace devseg {

namespace {

constexpr double margin = 10.0; // mm, what printers and cutters leave free at most

// Importers that scale drawings do it unseen: a ruler on this square shows it.
constexpr double check_square = 50.0; // mm
constexpr double check_text = 8.0;    // mm, font size

// Names fill this share of the circle around their place, up to a size that is easy to read.
constexpr double name_share = 0.7;
constexpr double largest_name = 8.0; // mm, font size
constexpr double letter_width = 0.6; // of the font size, digits and capitals of common fonts

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

const char* const cut_colour = "#ff0000";
const char* const mark_colour = "#000000";

DrawingPolyline rectangle(const Vec2& low, const Vec2& size) {
    return {{low, low + Vec2(size.x(), 0.0), low + size, low + Vec2(0.0, size.y())}, true};
}

DrawingPolyline shifted(const std::vector<Vec2>& points, const Vec2& offset) {
    DrawingPolyline line;
    line.points.reserve(points.size());
    for (const Vec2& p : points)
        line.points.push_back(p + offset);
    return line;
}

// The place of the pieces and of the check square: one above the other, or side by side, whatever
// takes the smaller sheet. Whole millimetres keep y exact when writers turn the sheet over.
struct SheetPlan {
    Vec2 pieces = Vec2::Constant(margin);
    Vec2 square = Vec2::Constant(margin);
    Vec2 size = Vec2::Zero();
};

SheetPlan plan_sheet(const Pattern& pattern) {
    const Vec2 layout(std::ceil(pattern.width), std::ceil(pattern.height));
    const double strip = check_square + margin;
    SheetPlan below;
    below.pieces.y() += strip;
    below.size = Vec2(std::max(layout.x(), check_square), layout.y() + strip).array() + 2 * margin;
    SheetPlan beside;
    beside.square.x() += layout.x() + margin;
    beside.size = Vec2(layout.x() + strip, std::max(layout.y(), check_square)).array() + 2 * margin;
    return beside.size.prod() < below.size.prod() ? beside : below;
}

DrawingPath cut_path(const PatternPiece& piece, const Vec2& offset) {
    DrawingPath path;
    path.id = piece.name + "-cut";
    path.parts.push_back(shifted(piece.outer.points, offset));
    for (const PiecePath& hole : piece.holes)
        path.parts.push_back(shifted(hole.points, offset));
    return path;
}

// Font size at which the name's box fits into the circle.
double name_size(const PatternPiece& piece) {
    const double half_width = 0.5 * letter_width * static_cast<double>(piece.name.size());
    return std::min(largest_name, name_share * piece.label_radius / std::hypot(half_width, 0.5));
}

// Area of a path whose points are rounded to the grid.
double rounded_area(const DrawingPath& path, double grid) {
    double twice = 0.0;
    for (const DrawingPolyline& part : path.parts) {
        const auto rounded = [&](std::size_t i) {
            const Vec2& p = part.points[i];
            return Vec2(std::round(p.x() / grid) * grid, std::round(p.y() / grid) * grid);
        };
        const Vec2 first = rounded(0);
        for (std::size_t i = 2; i < part.points.size(); ++i) {
            const Vec2 p = rounded(i - 1) - first;
            const Vec2 q = rounded(i) - first;
            twice += p.x() * q.y() - p.y() * q.x();
        }
    }
    return 0.5 * twice;
}

int decimals_for(const Pattern& pattern, const DrawingLayer& cut) {
    double total = 0.0;
    for (const PatternPiece& piece : pattern.pieces)
        total += piece.area;
    const auto holds = [&](double grid) {
        for (std::size_t i = 0; i < cut.paths.size(); ++i) {
            const double area = pattern.pieces[i].area;
            const double allowed = area_tolerance * std::max(area, negligible_piece * total);
            if (std::abs(rounded_area(cut.paths[i], grid) - area) > allowed)
                return false;
        }
        return true;
    };
    const double finest = grid_share * std::max(pattern.width, pattern.height);
    int decimals = usual_decimals;
    while (decimals < most_decimals &&
           (std::pow(10.0, -decimals) > finest || !holds(std::pow(10.0, -decimals))))
        ++decimals;
    return decimals;
}

DrawingLayer cut_layer(const Pattern& pattern, const Vec2& offset) {
    DrawingLayer layer{"cut", "Cut", cut_colour, {}, {}, {}};
    for (const PatternPiece& piece : pattern.pieces)
        layer.paths.push_back(cut_path(piece, offset));
    return layer;
}

DrawingLayer scale_layer(const SheetPlan& plan) {
    DrawingLayer layer{"scale", "Scale check", mark_colour, {}, {}, {}};
    const Vec2 side = Vec2::Constant(check_square);
    layer.paths.push_back({"frame", {rectangle(Vec2::Zero(), plan.size)}});
    layer.paths.push_back({"check-square", {rectangle(plan.square, side)}});
    layer.texts.push_back({plan.square + 0.5 * side, check_text, "50 mm"});
    return layer;
}

DrawingLayer text_layer(const Pattern& pattern, const Vec2& offset) {
    DrawingLayer layer{"text", "Text", mark_colour, {}, {}, {}};
    for (const PatternPiece& piece : pattern.pieces)
        if (piece.label_radius > 0.0)
            layer.texts.push_back({piece.label_position + offset, name_size(piece), piece.name});
    return layer;
}

} // namespace

Drawing draw_pattern(const Pattern& pattern, const PatternOptions& options) {
    const SheetPlan plan = plan_sheet(pattern);
    Drawing drawing;
    drawing.width = plan.size.x();
    drawing.height = plan.size.y();
    drawing.layers.push_back(cut_layer(pattern, plan.pieces));
    drawing.decimals = decimals_for(pattern, drawing.layers.front());
    drawing.layers.push_back(scale_layer(plan));
    if (options.labels)
        drawing.layers.push_back(text_layer(pattern, plan.pieces));
    return drawing;
}

} // namespace devseg
