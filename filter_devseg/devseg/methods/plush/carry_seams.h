// Seams of one surface on another that lies nearly at the same place.
#pragma once

#include "devseg/methods/plush/seam_paths.h"

namespace devseg::plush {

/// The seams of `from` (3 #F of it) as paths on `to`: the ends of their segments go to the nearest
/// vertices, and a path follows each segment closely; it leans to edges where seams look natural
/// (`stray`, 3 #F of `to`, 0 … 1: where they do not). Returns 3 #F of `to`.
SeamMarks carry_seams(const Mesh& from, const SeamMarks& seam, const Mesh& to,
                      const VertexGraph& graph, const std::vector<double>& stray,
                      Progress& progress);

/// Seams along two edges of a face take the third one; where they meet others, one of the two does.
/// A face that hangs on one edge, or in an acute corner, keeps its area badly. Seams only become
/// shorter.
void cut_corners(const Mesh& mesh, SeamMarks& seam);

} // namespace devseg::plush
