// The seams of a segmentation as a network: segments between the places where they meet.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::plush {

/// Marks of half-edges (3 #F), symmetric: a half-edge and its twin agree.
using SeamMarks = std::vector<std::uint8_t>;

void mark(const Mesh& mesh, HalfEdge half_edge, std::uint8_t value, SeamMarks& seam);

/// A line of seam edges from one end to the next. Ends are the vertices where not exactly two seam
/// edges meet, those on the mesh's boundary, and where material borders begin.
struct SeamSegment {
    std::vector<Index> half_edges; // head to tail, the first side's; the twins are the other side
    bool is_loop = false;          // without any end
    bool is_hard = false;          // a border between materials: it must stay
    double length = 0.0;           // internal units
    double weight = 0.0;           // mean weight of its edges: low where a seam looks natural
};

/// All segments, in the order of their lowest half-edge. `hard` is 3 #F or empty; `weight` is the
/// weight of each half-edge (3 #F, twins agree).
std::vector<SeamSegment> find_segments(const Mesh& mesh, const SeamMarks& seam,
                                       const SeamMarks& hard, const std::vector<double>& weight);

/// Seam edges at each vertex, #V; the mesh's own boundary edges count too.
std::vector<Index> seam_degrees(const Mesh& mesh, const SeamMarks& seam);

/// The patches that hold the given faces, each with its faces in ascending order.
std::vector<std::vector<Index>> patches_of(const Mesh& mesh, const SeamMarks& seam,
                                           const std::vector<Index>& faces);

/// The labels of the patches, #F: the components of the faces over edges that are no seam.
mesh::FaceComponents find_patches(const Mesh& mesh, const SeamMarks& seam);

} // namespace devseg::plush
