#include "surface/registration.h"

#include <cmath>

#include "devseg/base/errors.h"
#include "writers/text.h"

namespace devseg::surface {

namespace {

constexpr double radius = 1.5; // mm, of a mark
constexpr double arm = 2.5;    // mm, of its cross
constexpr double clear = 0.5;  // mm to the paper's edge and to the pieces
constexpr int circle_points = 48;

writers::DrawingPolyline circle(const Vec2& middle, double r) {
    writers::DrawingPolyline line;
    for (int i = 0; i < circle_points; ++i) {
        const double angle = 2.0 * pi * i / circle_points;
        line.points.push_back(middle + r * Vec2(std::cos(angle), std::sin(angle)));
    }
    return line;
}

} // namespace

writers::DrawingLayer registration_marks(const std::vector<writers::DrawingSheet>& sheets,
                                         double margin) {
    if (margin < 2.0 * (arm + clear))
        throw InvalidParameter(
            "page_margin_mm: expected " + writers::number_text(2.0 * (arm + clear), 0) +
            " mm or more for registration marks, found " + writers::number_text(margin, 3));
    writers::DrawingLayer layer{"registration", "Registration marks", "#000000", {}, {}, {}};
    for (const writers::DrawingSheet& sheet : sheets)
        for (const Vec2& corner : {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)}) {
            const Vec2 inset = 0.5 * margin * (Vec2::Ones() - 2.0 * corner);
            const Vec2 p = sheet.low + sheet.size.cwiseProduct(corner) + inset;
            writers::DrawingPath mark;
            mark.parts = {circle(p, radius),
                          {{p - Vec2(arm, 0.0), p + Vec2(arm, 0.0)}, false},
                          {{p - Vec2(0.0, arm), p + Vec2(0.0, arm)}, false}};
            if (corner == Vec2::Zero())
                mark.parts.push_back(circle(p, 0.5 * radius));
            layer.paths.push_back(std::move(mark));
        }
    return layer;
}

writers::DrawingLayer registration_marks(const sheet::PatternLayout& layout,
                                         const writers::Drawing& drawing, const Vec2& sheet_low) {
    if (layout.page)
        return registration_marks(drawing.pages, layout.page->margin);
    return registration_marks({{sheet_low, layout.sheets.front().size}}, sheet::sheet_margin);
}

} // namespace devseg::surface
