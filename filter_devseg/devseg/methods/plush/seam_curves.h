// Seams as smooth curves on the surface, before they become edges of another one.
#pragma once

#include "devseg/methods/plush/seam_network.h"

namespace devseg::plush {

/// Where the vertices on seams go when the seams become shorter, a few edges wide: like threads
/// that slide on the surface, which makes them straight, takes away teeth, and turns the acute
/// corners where two seams run side by side before they meet into obtuse ones. The ends of darts
/// and vertices on the mesh's boundary stay. #V; the mesh's own points elsewhere.
std::vector<Vec3> smooth_seams(const Mesh& mesh, const SeamMarks& seam);

} // namespace devseg::plush
