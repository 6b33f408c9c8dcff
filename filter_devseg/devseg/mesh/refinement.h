// A mesh with some of its faces split: the same surface, with new vertices on the old faces.
#pragma once

#include <array>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

struct Refinement {
    struct Point {
        Face face;    // of the old mesh
        Vec3 weights; // barycentric: of the face's corners, exactly 0 where it lies on an edge
    };
    struct Part {
        Index face;                  // of the new mesh
        Face source;                 // the old face that it is a part of
        std::array<Vec3, 3> corners; // barycentric: each corner in the old face
    };
    std::vector<Point> points; // new vertices, after the old ones
    std::vector<Part> parts;   // all faces that are not as they were, ascending
    Mesh mesh;                 // old face f is face f, or its first part is; the others follow
};

/// The edge of the old face that edge e of a part lies on, −1 for edges inside the face.
Index old_edge(const Refinement::Part& part, Index e);

/// A face before it is split: its boundary and the lines inside, in points of the new mesh.
struct SplitFace {
    Face face;
    std::vector<Index> points;   // corners first, then others
    std::vector<Vec3> weights;   // of each: barycentric
    std::vector<Triangle> parts; // positions in `points`
};

/// Replaces the faces by their parts, which must fill them, points on edges being in both faces.
Refinement refine(const Mesh& mesh, std::vector<Refinement::Point> points,
                  const std::vector<SplitFace>& splits);

} // namespace devseg::mesh
