// Faces as hosts have them: which are proper, which lie side by side, and how they are oriented.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::mesh {

struct FaceSelection {
    std::vector<Index> kept;         // faces that go on
    std::vector<Index> duplicate_of; // #source faces: the earlier face on the same vertices, or −1
    Index repeated = 0;              // faces that name a vertex twice
    Index duplicates = 0;
};

/// Leaves out faces that repeat a vertex or an earlier face.
FaceSelection select_proper_faces(const std::vector<Triangle>& faces, Index vertex_count);

/// The other half-edge of each edge that has exactly two faces, whatever their directions (3 #F).
/// `crowded` (3 #F) becomes 1 on the half-edges of those that have more.
std::vector<HalfEdge> neighbours_regardless_of_direction(const Mesh& mesh,
                                                         std::vector<std::uint8_t>& crowded);

struct Orientation {
    std::vector<std::uint8_t> flipped; // #F
    Index turned = 0;                  // faces turned over
    Index one_sided_edges = 0;         // edges where no coherent orientation exists
};

/// Breadth-first over each component; the orientation that most faces had is kept. `neighbour` and
/// `cut` are 3 #F, and change where there is no coherent orientation.
Orientation orient(const Mesh& mesh, std::vector<HalfEdge>& neighbour,
                   std::vector<std::uint8_t>& cut);

} // namespace devseg::mesh
