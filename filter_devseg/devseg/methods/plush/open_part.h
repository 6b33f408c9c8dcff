// Parts of a surface where seams are still to be decided.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/methods/plush/patch_trial.h"
#include "devseg/methods/plush/seam_paths.h"

namespace devseg::plush {

struct OpenPart {
    std::vector<std::uint8_t> faces; // #F: 1 where they are open; empty: everywhere
    SeamMarks seam;                  // 3 #F: seams so far; or empty

    bool is_open(Face f) const { return faces.empty() || faces[f] != 0; }
    bool has_open_faces() const;
    /// Whether both faces of the edge are open.
    bool is_inside(const Mesh& mesh, HalfEdge h) const;
};

/// The patches that do not keep the limits, where a few cuts do not help: `mend_patch` gives the
/// others theirs. `cost`: of paths, 3 #F.
OpenPart mend_patches(const Mesh& mesh, const VertexGraph& graph, const std::vector<double>& cost,
                      SeamMarks seam, const PatchLimits& limits, Progress& progress);

/// Seams that are not inside the open part.
SeamMarks fixed_seams(const Mesh& mesh, const OpenPart& part);

/// The patches of the working surface most of which lie on an open part of the model, and their
/// mirror images.
OpenPart same_part(const WorkingSurface& surface, SeamMarks seam, const Mesh& model,
                   const OpenPart& on_model);

} // namespace devseg::plush
