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

} // namespace devseg::sheet
