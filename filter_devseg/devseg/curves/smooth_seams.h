// Seams on mesh edges → smooth curves on the surface, along which the faces are split.
//
// References
//   S. Bischoff, T. Weyand, L. Kobbelt: Snakes on Triangle Meshes. Bildverarbeitung für die
//   Medizin, 2005. doi:10.1007/3-540-26431-0_43
#pragma once

#include <optional>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/option_checks.h"
#include "devseg/base/progress.h"
#include "devseg/curves/curved_vertices.h"
#include "devseg/mesh/mirror_plane.h"
#include "devseg/mesh/refinement.h"

namespace devseg::curves {

struct SmoothOptions {
    double smoothness = 0.01;   // length of the waves that go, as a share of the diagonal
    double keep_creases = 30.0; // degrees: seams on edges that bend by more stay where they are
    bool symmetric = false;     // seams that nearly mirror each other do so exactly

    static auto ranges() {
        using O = SmoothOptions;
        return OptionRanges<O>{{&O::smoothness, {"smoothness", 0.0, 0.2}},
                               {&O::keep_creases, {"keep_creases", 0.0, 180.0}}};
    }
};

struct SmoothSeams {
    mesh::Refinement refinement; // the finer mesh, the same surface
    atlas::ChartMap charts;      // of the finer mesh, with the labels that the charts had
    Index smooth_seams = 0;      // curves between junctions, darts and slits
    Index kept_seams = 0;        // that stay on their edges, those on creases included
    bool has_plane = false;      // in which seams were made symmetric
    double old_length = 0.0;     // of all seams, internal units
    double new_length = 0.0;
};

/// Length of the waves that go, internal units.
double smoothing_scale(const Mesh& mesh, const atlas::ChartMap& charts,
                       const SmoothOptions& options);

/// The plane in which `options` want seams to be symmetric; none where the mesh has none.
std::optional<mesh::MirrorPlane> seam_plane(const Mesh& mesh, const SmoothOptions& options,
                                            Progress& progress);

/// `firmness` (3 #F, or empty): of each seam edge, both half-edges.
SmoothSeams smooth_seams(const Mesh& mesh, const atlas::ChartMap& charts,
                         const SmoothOptions& options,
                         const std::optional<mesh::MirrorPlane>& plane, Progress& progress,
                         const std::vector<Firmness>& firmness = {});

/// The same with the plane that is found.
SmoothSeams smooth_seams(const Mesh& mesh, const atlas::ChartMap& charts,
                         const SmoothOptions& options, Progress& progress);

} // namespace devseg::curves
