// Where to write a name into a piece: the point inside that is farthest from all outlines.
#pragma once

#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::pattern {

struct LabelPoint {
    Vec2 position = Vec2::Zero();
    double radius = 0.0; // distance from the nearest outline, same units; 0 = no inside found
};

/// The pole of inaccessibility of the area that the closed outlines bound by the even-odd rule,
/// within 2 % of its radius. The outer outline comes first. Always inside where there is one,
/// however thin the piece.
LabelPoint find_label_point(const std::vector<const std::vector<Vec2>*>& outlines);

} // namespace devseg::pattern
