// The way back to source faces that the gate has left out.
#pragma once

#include <vector>

#include "devseg/mesh/input_gate.h"

namespace devseg::mesh {

/// All source faces.
struct SourceFaces {
    const std::vector<Triangle>& given;     // with the host's vertices
    const std::vector<Triangle>& joined;    // with those that stand for others
    const std::vector<Index>& duplicate_of; // the earlier face on the same vertices, or −1
};

/// Fills `stand_in` and `collapsed`. A face that was left out takes the results of the face that it
/// repeats, of one on whose edge it lies, of one beside it, or of one that shares a vertex with it.
void find_stand_ins(const SourceFaces& faces, std::size_t vertex_count, GatedMesh& gated);

} // namespace devseg::mesh
