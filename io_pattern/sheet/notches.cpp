// Notches and the grain line: the marks of marks.h that are no texts.
#include <algorithm>
#include <cmath>

#include "devseg/plane/plane.h"
#include "sheet/marks.h"

namespace devseg::sheet {

namespace {

constexpr double mark_length = 4.0;    // mm: of notches where there is no allowance, of arrow heads
constexpr double notch_share = 0.6;    // of the allowance
constexpr double arrow_angle = 0.4;    // radians
constexpr double shortest_grain = 6.0; // mm: less cannot be laid along a thread

// Distance from p along the direction to the nearest cut line, or a negative number.
double reach(const SheetPiece& piece, const Vec2& p, const Vec2& direction, double most) {
    double best = -1.0;
    for (const std::vector<Vec2>& ring : piece.cut)
        for (std::size_t i = 0; i < ring.size(); ++i) {
            const Vec2 a = ring[i] - p;
            const Vec2 d = ring[(i + 1) % ring.size()] - ring[i];
            const double across = plane::cross(direction, d);
            if (across == 0.0)
                continue;
            const double t = plane::cross(a, d) / across;
            const double s = plane::cross(a, direction) / across;
            if (s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= most && (best < 0.0 || t < best))
                best = t;
        }
    return best;
}

// In the allowance, from the cut line towards the sew line; without one, and in the folded
// allowance of a narrow dart, from the sew line inwards.
void add_notch(const pattern::PiecePath& path, const pattern::SeamSide& side, double distance,
               double allowance, SheetPiece& result) {
    const OutlinePlace place = place_on(path, side, distance);
    const Vec2 outward(place.direction.y(), -place.direction.x());
    if (allowance > 0.0) {
        const double out = reach(result, place.position, outward, 1.01 * allowance);
        if (out > 0.0) {
            result.notches.push_back({place.position + out * outward,
                                      place.position + (1.0 - notch_share) * out * outward});
            return;
        }
    }
    result.notches.push_back({place.position, place.position - mark_length * outward});
}

} // namespace

void add_notches(const pattern::Pattern& pattern, const ExportOptions& options,
                 SheetPiece& result) {
    const pattern::PatternPiece& piece = pattern.pieces[result.piece];
    const AllowanceWidths widths = options.allowance();
    for (const Index s : piece.seams())
        for (const pattern::SeamSide& side : pattern.seams[at(s)].sides) {
            if (side.piece != result.piece)
                continue;
            const pattern::OutlineSeam edge{s, 0, pattern.seams[at(s)].is_dart};
            for (const double distance : side.notches)
                add_notch(piece.path(side.path), side, distance, widths.of(edge, side.path > 0),
                          result);
        }
}

void add_grain(const pattern::PatternPiece& piece, SheetPiece& result) {
    const Vec2 from = piece.grain[0];
    const Vec2 to = piece.grain[1];
    const double length = (to - from).norm();
    if (length < shortest_grain)
        return;
    result.grain_line = piece.grain;
    const Vec2 direction = (to - from) / length;
    const double head = std::min(mark_length, 0.3 * length);
    const auto barb = [&](const Vec2& tip, const Vec2& along, double angle) {
        return Vec2(tip - head * (Eigen::Rotation2Dd(angle) * along));
    };
    result.grain = {
        {from, to},
        {barb(to, direction, arrow_angle), to, barb(to, direction, -arrow_angle)},
        {barb(from, -direction, arrow_angle), from, barb(from, -direction, -arrow_angle)}};
}

} // namespace devseg::sheet
