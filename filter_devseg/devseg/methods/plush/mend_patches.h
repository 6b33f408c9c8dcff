// Small repairs of patches that nearly keep their limits, and of those that are too small to be
// pieces of cloth.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "devseg/methods/plush/patch_tester.h"

namespace devseg::plush {

/// Cuts that make a patch keep the limits: half-edges, none where it keeps them already. While its
/// map lies on itself, it is cut in two between the sheets; else it gets darts, each from the
/// vertex that a conformal map shrinks most, where curvature gathers, to the nearest seam, so that
/// it may make an earlier dart longer. Nothing where a few cuts are not enough. `cost`: of paths,
/// 3 #F.
std::optional<std::vector<Index>> mend_patch(const Mesh& mesh, const VertexGraph& graph,
                                             const std::vector<double>& cost,
                                             const std::vector<Index>& faces, const SeamMarks& seam,
                                             const judge::ClothLimits& limits,
                                             const Progress& progress);

/// A part of a surface where seams are still to be decided.
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
                      SeamMarks seam, const judge::ClothLimits& limits, Progress& progress);

/// Seams that are not inside the open part.
SeamMarks fixed_seams(const Mesh& mesh, const OpenPart& part);

/// The patches of the working surface most of which lie on an open part of the model, and their
/// mirror images.
OpenPart same_part(const WorkingSurface& surface, SeamMarks seam, const Mesh& model,
                   const OpenPart& on_model);

/// Patches that are nothing but specks, as where two paths of a transfer cross, go to a neighbour:
/// rather to one whose border with them no other seam meets, since that would lose its end.
SeamMarks absorb_specks(const Mesh& mesh, SeamMarks seam);

/// Joins patches up to a share of the surface to a neighbour along all of their common border,
/// where darts up to half as long again as that border are enough to keep the limits. `cost`: of
/// paths for darts, 3 #F. Returns how many joins were tried.
Index absorb_remnants(const SeamSetting& setting, const std::vector<double>& cost, double most_area,
                      SeamMarks& seam, Progress& progress);

} // namespace devseg::plush
