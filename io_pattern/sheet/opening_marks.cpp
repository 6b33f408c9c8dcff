#include "sheet/marks.h"

namespace devseg::sheet {

namespace {

constexpr double bracket_depth = 2.0; // mm, from the sew line inwards
constexpr int bracket_parts = 8;      // of the line along a stretch

} // namespace

std::pair<double, double> opening_stretch(const pattern::Seam& seam, std::size_t side,
                                          const assembly::Opening& opening) {
    const double ratio = seam.sides[side].length / seam.sides[0].length;
    return {ratio * opening.from, ratio * opening.to};
}

void add_openings(const pattern::Pattern& pattern, const assembly::Assembly& assembly,
                  SheetPiece& result) {
    for (const assembly::Opening& opening : assembly.openings) {
        const pattern::Seam& seam = pattern.seams[at(opening.seam)];
        for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
            const pattern::SeamSide& side = seam.sides[k];
            if (side.piece != result.piece)
                continue;
            const auto [from, to] = opening_stretch(seam, k, opening);
            const pattern::PiecePath& path = pattern.pieces[at(side.piece)].path(side.path);
            std::vector<Vec2> bracket;
            for (int i = 0; i <= bracket_parts; ++i) {
                const OutlinePlace place =
                    place_on(path, side, from + (to - from) * i / bracket_parts);
                const Vec2 inward(-place.direction.y(), place.direction.x());
                const Vec2 inside = place.position + bracket_depth * inward;
                if (i == 0)
                    bracket.push_back(place.position);
                bracket.push_back(inside);
                if (i == bracket_parts)
                    bracket.push_back(place.position);
            }
            result.openings.push_back(std::move(bracket));
        }
    }
}

void add_drills(const pattern::Pattern& pattern, SheetPiece& result) {
    constexpr double half = 1.5; // mm
    const pattern::PatternPiece& piece = pattern.pieces[at(result.piece)];
    for (const Index s : piece.seams()) {
        const pattern::Seam& seam = pattern.seams[at(s)];
        const pattern::SeamSide& side = seam.sides[0];
        if (!seam.is_dart || side.piece != result.piece)
            continue;
        const std::vector<Vec2>& points = piece.path(side.path).points;
        const auto point = [&](const pattern::SeamSide& of, bool at_end) {
            const Index steps = at_end != of.reversed ? of.count : 0;
            return points[at(of.first + steps) % points.size()];
        };
        // Both sides meet at the tip.
        const bool at_end = point(seam.sides[0], true) == point(seam.sides[1], true);
        const Vec2 tip = point(side, at_end);
        for (const Vec2& arm : {Vec2(half, 0.0), Vec2(0.0, half)})
            result.drills.push_back({tip - arm, tip + arm});
    }
}

} // namespace devseg::sheet
