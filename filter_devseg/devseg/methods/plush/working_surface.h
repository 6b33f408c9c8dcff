// The surface on which seams are decided: coarse, and its own mirror image where the model nearly
// is one.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/mirror_plane.h"
#include "devseg/methods/plush/seam_network.h"

namespace devseg::plush {

using mesh::find_mirror_plane;
using mesh::MirrorPlane;

/// With a mirror plane, faces n … 2n − 1 are the mirror images of faces 0 … n − 1, in their order,
/// and edges along the plane divide the two.
struct WorkingSurface {
    Mesh mesh;
    std::vector<Index> image; // 3 #F: the half-edge on the mirrored edge, an involution; or empty
    MirrorPlane side{};       // the first half lies below it

    bool is_symmetric() const { return !image.empty(); }
    Face face_image(Face f) const { return face_of(image[half_edge_of(f, 0)]); }
    /// Whether the origin of the half-edge is its own mirror image.
    bool starts_on_plane(HalfEdge h) const {
        return is_symmetric() && mesh.target(image[h]) == mesh.origin(h);
    }
    /// Whether the edge lies on the plane, between the two halves.
    bool is_on_plane(HalfEdge h) const { return is_symmetric() && image[h] == mesh.twin[h]; }
    bool is_image(HalfEdge h) const {
        return is_symmetric() && face_of(h) >= mesh.face_count() / 2 && !is_on_plane(h);
    }
};

/// The mesh with at most about `most_faces` faces, without a mirror plane.
WorkingSurface plain_working_surface(const Mesh& mesh, Index most_faces, Progress& progress);

/// The part of the mesh on one side of the plane, as it is up to half of `kept_faces`, else
/// coarsened to half of `most_faces`, with its mirror image, glued along the plane: the side that
/// changes the surface's topology and area less. Nothing where both sides change the topology.
std::optional<WorkingSurface> mirrored_working_surface(const Mesh& mesh, const MirrorPlane& plane,
                                                       Index most_faces, Index kept_faces,
                                                       const Progress& progress);

/// The part of the mesh below the plane as it is, with its mirror image.
struct MirroredModel {
    WorkingSurface surface;
    // #V of the surface: the vertex of the mesh that is there; on the plane an end of the edge that
    // was cut, so that lines along the plane become short; −1 on the mirror image. Neighbours have
    // neighbours, or the same.
    std::vector<Index> place;
};
/// Nothing where it has another topology than the mesh.
std::optional<MirroredModel> mirrored_model(const Mesh& mesh, const MirrorPlane& side);

/// Marks (3 #F) of the first half on both halves.
void mirror_marks(const WorkingSurface& surface, SeamMarks& marks);

/// Lines of half-edges, and their mirror images behind them.
std::vector<std::vector<Index>> with_image(const WorkingSurface& surface,
                                           std::vector<std::vector<Index>> lines);

/// Marks a line of half-edges and its mirror image.
void mark_both(const WorkingSurface& surface, const std::vector<Index>& line, std::uint8_t value,
               SeamMarks& marks);

} // namespace devseg::plush
