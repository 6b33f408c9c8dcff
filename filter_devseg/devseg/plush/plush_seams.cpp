#include "devseg/plush/plush_seams.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "devseg/parallel.h"
#include "devseg/plush/limbs.h"
#include "devseg/plush/local_seams.h"
#include "devseg/plush/patch_trial.h"
#include "devseg/plush/seam_removal.h"
#include "devseg/plush/seam_smoothing.h"
#include "devseg/plush/symmetry.h"
#include "devseg/segment/fragments.h"

namespace devseg {

void plush_dump();
namespace {

constexpr double symmetric_enough = 0.03; // of the diagonal
constexpr double fragment = 4e-4;         // of the surface: smaller parts go to a neighbour

// The seams of one side and their mirror images, and the line between the two sides.
SeamMarks mirror_seams(const Mesh& mesh, const std::vector<std::uint8_t>& side,
                       const std::vector<Index>& image, SeamMarks seam) {
    for (Index h = 0; h < mesh.half_edge_count(); ++h)
        if (mesh.twin[at(h)] >= 0 && side[at(h / 3)] != side[at(mesh.twin[at(h)] / 3)])
            seam[at(h)] = 1;
    const FaceComponents patches = find_patches(mesh, seam);
    std::vector<Index> label = patches.label;
    for (Index f = 0; f < mesh.face_count(); ++f)
        if (side[at(f)] != 0)
            label[at(f)] = patches.count + patches.label[at(image[at(f)])];
    label = absorb_fragments(mesh, label, fragment);
    remove_teeth(mesh, {}, label);
    return make_chart_map(mesh, label, {}, false).seam;
}

} // namespace

PlushSeams segment_plush_seams(const Mesh& mesh, const PlushOptions& options, Skeleton skeleton,
                               const std::vector<std::uint8_t>& hard, Progress& progress) {
    PlushSeams result;
    progress.begin_phase("finding the skeleton", 0.1);
    if (skeleton.empty())
        skeleton = extract_skeleton(mesh, progress);
    result.bones = static_cast<Index>(skeleton.bones.size());
    BoneWeights bones;
    if (!skeleton.empty())
        bones = bone_weights(mesh, skeleton, progress);
    const VertexGraph graph = build_vertex_graph(mesh);
    const auto most = static_cast<Index>(std::sqrt(static_cast<double>(mesh.points.size())));
    const std::vector<Index> extrema =
        find_extrema(graph, conformal_factor(mesh), options.max_extrema > 0 ? options.max_extrema : most);
    result.extrema = static_cast<Index>(extrema.size());
    const std::vector<double> curvature = mean_curvature(mesh);
    const std::vector<double> weight =
        seam_weights(mesh, {options.geodesic_weight, options.skeleton_weight, options.curvature_weight},
                     curvature, skeleton, bones);
    SeamMarks seam(mesh.twin.size(), 0);
    progress.begin_phase("structural seams", 0.1);
    std::optional<MirrorPlane> plane;
    if (options.symmetric)
        plane = find_mirror_plane(mesh, symmetric_enough, progress);
    std::vector<std::uint8_t> side;
    std::vector<Index> image;
    std::vector<Index> mirror;
    if (plane) {
        result.is_symmetric = true;
        side = sides_of(mesh, *plane);
        image = mirror_faces(mesh, *plane, side);
        mirror = mirror_vertices(mesh, *plane);
        std::fprintf(stderr, "plane %f %f %f dev %f\n", plane->normal.x(), plane->normal.y(), plane->normal.z(), plane->deviation);
        for (Index h = 0; h < mesh.half_edge_count(); ++h)
            if (mesh.twin[at(h)] >= 0 && side[at(h / 3)] != side[at(mesh.twin[at(h)] / 3)])
                seam[at(h)] = 1;
    }
    const std::vector<Limb> limbs = find_limbs(mesh, graph, curvature, extrema, progress);
    result.limbs = static_cast<Index>(limbs.size());
    if (std::getenv("PL_LIMBS")) { for (auto& l : limbs) { SeamMarks m(seam.size(),0); add_limb_seams(mesh,{l},m); std::fprintf(stderr,"limb tip %d faces %zu\n", l.tip, l.faces.size()); } }
    add_limb_seams(mesh, limbs, seam);
    add_structural_seams(mesh, graph, weight, extrema, seam, progress);
    if (plane)
        seam = mirror_seams(mesh, side, image, seam);
    std::fprintf(stderr, "extrema %d bones %d limbs %d patches %d\n", result.extrema, result.bones, result.limbs, find_patches(mesh, seam).count);
    progress.begin_phase("local seams", 0.2);
    LocalSeams local = add_local_seams(mesh, graph, weight, options.max_area_change, seam, progress);
    if (plane) {
        seam = mirror_seams(mesh, side, image, seam);
        local = add_local_seams(mesh, graph, weight, options.max_area_change, seam, progress);
    }
    result.all_developable = local.all_developable;
    result.candidates = static_cast<Index>(find_segments(mesh, seam, hard, weight).size());
    std::fprintf(stderr, "splits %d patches %d segments %d all %d\n", local.splits, find_patches(mesh, seam).count, result.candidates, local.all_developable);
    plush_dump();
    progress.begin_phase("removing seams", 0.25);
    RemovalOptions removal;
    if (const char* e = std::getenv("PL")) std::sscanf(e, "%lf,%lf", &removal.length_power, &removal.size_power);
    const SeamSetting setting{mesh, hard, weight, mirror, options.max_area_change};
    result.trials = remove_seams(setting, removal, seam, progress);
    std::fprintf(stderr, "trials %d patches %d\n", result.trials, find_patches(mesh, seam).count);
    plush_dump();
    progress.begin_phase("joining patches with darts", 0.25);
    double neck = 0.3;
    if (const char* e = std::getenv("PLD")) neck = std::atof(e);
    result.trials += join_patches(setting, neck, seam, progress);
    std::fprintf(stderr, "trials %d patches %d\n", result.trials, find_patches(mesh, seam).count);
    plush_dump();
    progress.begin_phase("straightening seams", 0.1);
    if (!std::getenv("PLNS")) std::fprintf(stderr, "straightened %d\n", straighten_seams(setting, graph, seam, progress));
    plush_dump();
    progress.begin_phase("shortening darts", 0.1);
    result.trials += shorten_darts(setting, seam, progress);
    std::fprintf(stderr, "trials %d patches %d\n", result.trials, find_patches(mesh, seam).count);
    plush_dump();
    result.charts = make_chart_map(mesh, find_patches(mesh, seam).label, seam, false);
    plush_dump();
    return result;
}

} // namespace devseg
