// Seams of one surface on another that lies nearly at the same place: as smooth curves, which
// become edges there.
#pragma once

#include "devseg/methods/plush/working_surface.h"

namespace devseg::plush {

/// Where the vertices on seams go when the seams become shorter, a few edges wide: like threads
/// that slide on the surface, which makes them straight, takes away teeth, and turns the acute
/// corners where two seams run side by side before they meet into obtuse ones. The ends of darts
/// and vertices on the mesh's boundary stay. #V; the mesh's own points elsewhere.
std::vector<Vec3> smooth_seams(const Mesh& mesh, const SeamMarks& seam);

/// What a transfer leaves as it is.
struct TransferRest {
    std::vector<std::uint8_t> edges; // 3 #F of the first surface: 1 = not carried over; or empty
    std::vector<std::uint8_t>
        closed;               // #V of the second one: 1 = paths may only end there; or empty
    std::vector<Index> place; // #V of the first one: its vertex where it is known, or −1
    SeamMarks seam;           // 3 #F of the second one: seams that there are already
    bool is_smooth = false;   // lines are carried over as they are
};

/// The seams of `from` (3 #F of it) as paths on `to`: the ends of their segments go to the nearest
/// vertices, and a path follows each segment closely; it leans to edges where seams look natural
/// (`factor`, 3 #F of `to`: of a path's length, less where they do). Seams that go around a face
/// along two of its edges take the third one. Returns 3 #F of `to`.
SeamMarks transfer_seams(const Mesh& from, const SeamMarks& seam, const Mesh& to,
                         const VertexGraph& graph, const std::vector<double>& factor,
                         TransferRest rest, Progress& progress);

/// The surface with its points moved onto the model, neighbours by nearly the same: limbs follow
/// those of the model, which are not quite where the mirror image has them. `graph`: of the
/// surface.
Mesh fitted_to(const Mesh& model, const Mesh& surface, const VertexGraph& graph,
               const Progress& progress);

/// The seams of a mirrored model on the model itself: edge by edge on its own half, but for teeth,
/// and on the other one as paths that keep close to the mirror images. `placed`: the surface with
/// its image moved onto the other half. `graph`: of the model.
SeamMarks seams_on_model(const MirroredModel& mirrored, const Mesh& placed, const SeamMarks& seam,
                         const Mesh& model, const VertexGraph& graph, Progress& progress);

} // namespace devseg::plush
