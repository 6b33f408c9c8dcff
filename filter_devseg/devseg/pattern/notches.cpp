#include "devseg/pattern/notches.h"

#include <algorithm>
#include <cmath>

#include "devseg/pattern/seams.h"

namespace devseg::pattern {

namespace {

// A seam shorter than this share of the spacing is sewn by its ends alone.
constexpr double shortest_seam = 0.5;
// The tip of a dart says which way round it goes, and holds its sides together.
constexpr double shortest_dart = 1.5;
// Bounds the drawing: closer notches than a thousand on a seam mark nothing.
constexpr double most_notches = 1000.0;

// The share u of even notches becomes u^p: p differs from seam to seam, so that sides of different
// seams do not fit by chance.
constexpr double least_power = 1.2;
constexpr double power_step = 0.05;
constexpr Index powers = 4;

// A notch keeps away from bends by moving along the seam, by these shares of the distance to its
// neighbour: an outline that turns by more than this angle near it is no place for a notch.
constexpr double shifts[] = {0.0, 0.08, -0.08, 0.16, -0.16, 0.24, -0.24, 0.32, -0.32};
constexpr double sharp_cosine = 0.87; // 30 degrees
constexpr double near_by = 2.5;       // mm on both sides

// Cosine of the angle by which the sides turn around this share of their length, the sharper one.
double straightness(const Pattern& pattern, const Seam& seam, double share) {
    double least = 1.0;
    for (const SeamSide& side : seam.sides) {
        const double reach = std::min(near_by, 0.1 * side.length);
        const SidePoint before = point_on_side(pattern.pieces, side, share * side.length - reach);
        const SidePoint after = point_on_side(pattern.pieces, side, share * side.length + reach);
        least = std::min(least, before.outward.dot(after.outward));
    }
    return least;
}

// The share of the seam, near the one that is wished, where it is straight enough.
double straight_place(const Pattern& pattern, const Seam& seam, double wish, double room) {
    double best = wish;
    double best_cosine = -2.0;
    for (const double shift : shifts) {
        const double share = wish + shift * room;
        const double cosine = straightness(pattern, seam, share);
        if (cosine > best_cosine) {
            best = share;
            best_cosine = cosine;
        }
        if (cosine >= sharp_cosine)
            break;
    }
    return best;
}

} // namespace

void set_notches(Pattern& pattern, double spacing_mm) {
    for (Seam& seam : pattern.seams) {
        for (SeamSide& side : seam.sides)
            side.notches.clear();
        const double length = std::min(seam.sides[0].length, seam.sides[1].length);
        const double shortest = seam.is_dart ? shortest_dart : shortest_seam;
        if (!(spacing_mm > 0.0) || !(length >= shortest * spacing_mm))
            continue;
        const double count = std::clamp(std::round(length / spacing_mm), 1.0, most_notches);
        const double power = least_power + power_step * static_cast<double>(seam.number % powers);
        const auto place = [&](double i) { return std::pow(i / count, power); };
        for (double i = 0.5; i < count; ++i) {
            const double room = std::min(place(i) - place(std::max(0.0, i - 1.0)),
                                         place(std::min(count, i + 1.0)) - place(i));
            const double share = straight_place(pattern, seam, place(i), room);
            for (SeamSide& side : seam.sides)
                side.notches.push_back(share * side.length);
        }
    }
}

} // namespace devseg::pattern
