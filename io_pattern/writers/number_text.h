// Numbers and points in files: fixed notation that knows no locale.
#pragma once

#include <string>
#include <vector>

#include "writers/drawing.h"

namespace devseg::writers {

/// At most `decimals` digits behind the point, no trailing zeros, no sign of −0. Finite numbers.
std::string number_text(double value, int decimals);

/// What `text` makes of the points, without those that read as the one before (in a closed line,
/// the last one comes before the first): cutters stop at each point.
template <class Text>
std::vector<std::string> point_texts(const DrawingPolyline& line, Text text) {
    std::vector<std::string> texts;
    for (const Vec2& p : line.points) {
        std::string next = text(p);
        if (texts.empty() || next != texts.back())
            texts.push_back(std::move(next));
    }
    if (line.closed && texts.size() > 1 && texts.back() == texts.front())
        texts.pop_back();
    return texts;
}

} // namespace devseg::writers
