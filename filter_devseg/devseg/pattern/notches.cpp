#include "devseg/pattern/notches.h"

#include <algorithm>
#include <cmath>

namespace devseg {

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
        for (double i = 0.5; i < count; ++i)
            for (SeamSide& side : seam.sides)
                side.notches.push_back(side.length * std::pow(i / count, power));
    }
}

} // namespace devseg
