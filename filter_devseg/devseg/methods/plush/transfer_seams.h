// Seams of one surface on another that lies nearly at the same place: as smooth curves, which
// become edges there.
#pragma once

#include "devseg/methods/plush/seam_network.h"

namespace devseg::plush {

/// Where the vertices on seams go when the seams become shorter, a few edges wide: like threads
/// that slide on the surface, which makes them straight, takes away teeth, and turns the acute
/// corners where two seams run side by side before they meet into obtuse ones. The ends of darts
/// and vertices on the mesh's boundary stay. #V; the mesh's own points elsewhere.
std::vector<Vec3> smooth_seams(const Mesh& mesh, const SeamMarks& seam);

/// Both surfaces in parts: a line keeps to its own, but for its ends. Empty: there is one.
struct TransferZones {
    static constexpr std::uint8_t left_out = 255;

    std::vector<std::uint8_t> line;   // 3 #F of the first surface; left_out: not carried over
    std::vector<std::uint8_t> end;    // #V of the first surface
    std::vector<std::uint8_t> vertex; // #V of the second one
    std::vector<Index> place;         // #V of the first one: the vertex where it is known, or −1
    SeamMarks seam;                   // 3 #F of the second one: seams that there are already
    bool is_smooth = false;           // lines are seams of such a surface as they are
};

/// The seams of `from` (3 #F of it) as paths on `to`: the ends of their segments go to the nearest
/// vertices, and a path follows each segment closely; it leans to edges where seams look natural
/// (`factor`, 3 #F of `to`: of a path's length, less where they do). Seams that go around a face
/// along two of its edges take the third one. Returns 3 #F of `to`.
SeamMarks transfer_seams(const Mesh& from, const SeamMarks& seam, const Mesh& to,
                         const VertexGraph& graph, const std::vector<double>& factor,
                         TransferZones zones, Progress& progress);

} // namespace devseg::plush
