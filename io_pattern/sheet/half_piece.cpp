#include "sheet/half_piece.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/plane/plane.h"

namespace devseg::sheet {

namespace {

// Sutherland and Hodgman's clipping at one line. A concave outline may lead along the fold more
// than once, forth and back.
std::vector<Vec2> right_half(const std::vector<Vec2>& ring) {
    std::vector<Vec2> half;
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vec2& a = ring[i];
        const Vec2& b = ring[(i + 1) % ring.size()];
        if (a.x() >= 0.0)
            half.push_back(a);
        if ((a.x() > 0.0 && b.x() < 0.0) || (a.x() < 0.0 && b.x() > 0.0))
            half.emplace_back(0.0, a.y() + a.x() / (a.x() - b.x()) * (b.y() - a.y()));
    }
    return half;
}

void keep_right(std::vector<std::vector<Vec2>>& lines) {
    lines.erase(std::remove_if(lines.begin(), lines.end(),
                               [](const std::vector<Vec2>& line) {
                                   return std::any_of(line.begin(), line.end(),
                                                      [](const Vec2& p) { return p.x() < 0.0; });
                               }),
                lines.end());
}

} // namespace

SheetPiece half_piece(const SheetPiece& whole, const pattern::MirrorAxis& axis, const Vec2& grain) {
    SheetPiece half = whole;
    Vec2 up = axis.direction;
    if (up.dot(grain) < 0.0)
        up = -up;
    const double angle = 0.5 * pi - std::atan2(up.y(), up.x());
    pack::Placement turn{std::cos(angle), std::sin(angle), Vec2::Zero()};
    turn.offset.x() = -turn(axis.point).x();
    half.move(turn);
    half.name += "-fold";
    half.cut_curves.clear();
    half.sew_curves.clear();
    for (auto* rings : {&half.cut, &half.sew}) {
        for (std::vector<Vec2>& ring : *rings)
            ring = right_half(ring);
        rings->erase(std::remove_if(rings->begin(), rings->end(),
                                    [](const std::vector<Vec2>& ring) { return ring.size() < 3; }),
                     rings->end());
    }
    for (auto* lines : {&half.slits, &half.mountains, &half.valleys, &half.openings, &half.grain,
                        &half.drills, &half.leaders})
        keep_right(*lines);
    half.notches.erase(std::remove_if(half.notches.begin(), half.notches.end(),
                                      [](const SheetNotch& n) { return n.outer.x() < 0.0; }),
                       half.notches.end());
    return half;
}

} // namespace devseg::sheet
