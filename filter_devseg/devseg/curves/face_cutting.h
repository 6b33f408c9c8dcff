// One triangle, cut along lines between points on its boundary and inside.
#pragma once

#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::curves {

/// Points of one triangle: its corners 0, 1, 2, then points on its edges, then points inside.
struct CutFace {
    std::vector<Vec2> points;
    std::vector<Index> ring;                    // the boundary, counterclockwise
    std::vector<std::pair<Index, Index>> lines; // between points, none of them on one edge
};

struct FaceParts {
    std::vector<Triangle> parts;
    double smallest_angle = 0.0; // radians; 0 or less where a part is turned over
    bool sound = false;          // the lines do not cross, and the parts fill the triangle
};

/// The triangulation along the lines whose smallest angle is largest.
FaceParts cut_face(const CutFace& face);

} // namespace devseg::curves
