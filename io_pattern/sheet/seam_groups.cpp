#include "sheet/seam_groups.h"

namespace devseg {

namespace {

double length_of(const Seam& seam) {
    return 0.5 * (seam.sides[0].length + seam.sides[1].length);
}

// Whether `next` begins where `side` ends, along the seam.
bool continues(const SeamSide& side, const SeamSide& next, const Pattern& pattern) {
    if (side.piece != next.piece || side.path != next.path || side.reversed != next.reversed)
        return false;
    const auto size =
        static_cast<Index>(pattern.pieces[at(side.piece)].path(side.path).points.size());
    const SeamSide& before = side.reversed ? next : side;
    const SeamSide& after = side.reversed ? side : next;
    return (before.first + before.count) % size == after.first;
}

void append(const Seam& next, Seam& group) {
    for (const std::size_t k : {std::size_t{0}, std::size_t{1}}) {
        SeamSide& side = group.sides[k];
        if (side.reversed)
            side.first = next.sides[k].first;
        side.count += next.sides[k].count;
        side.length += next.sides[k].length;
    }
    group.surface_length += next.surface_length;
    group.is_dart = next.is_dart;
}

} // namespace

std::vector<Seam> group_seams(const Pattern& pattern, double least) {
    std::vector<Seam> groups;
    std::string first;
    for (const Seam& seam : pattern.seams) {
        const bool joins = !groups.empty() && !groups.back().is_dart && !groups.back().is_closed &&
                           !seam.is_closed &&
                           (length_of(seam) < least || length_of(groups.back()) < least) &&
                           continues(groups.back().sides[0], seam.sides[0], pattern) &&
                           continues(groups.back().sides[1], seam.sides[1], pattern);
        if (joins) {
            append(seam, groups.back());
            groups.back().label = first + '-' + seam.label;
        } else {
            groups.push_back(seam);
            first = seam.label;
        }
    }
    return groups;
}

} // namespace devseg
