#include "devseg/plush/plush_seams.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "devseg/parallel.h"
#include "devseg/plush/local_seams.h"
#include "devseg/plush/patch_trial.h"
#include "devseg/plush/seam_removal.h"

namespace devseg {

namespace {

std::vector<double> angle_defects(const Mesh& mesh) {
    std::vector<double> defect(mesh.points.size(), 2.0 * 3.14159265358979323846);
    for (Index h = 0; h < mesh.half_edge_count(); ++h) {
        const Vec3& corner = mesh.points[at(mesh.origin(h))];
        const Vec3 p = mesh.points[at(mesh.target(h))] - corner;
        const Vec3 q = mesh.points[at(mesh.origin(Mesh::previous(h)))] - corner;
        defect[at(mesh.origin(h))] -= std::atan2(p.cross(q).norm(), p.dot(q));
    }
    for (double& d : defect)
        d = std::abs(d);
    return defect;
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
    const std::vector<double> weight =
        seam_weights(mesh, {options.geodesic_weight, options.skeleton_weight, options.curvature_weight},
                     mean_curvature(mesh), skeleton, bones);
    SeamMarks seam(mesh.twin.size(), 0);
    progress.begin_phase("structural seams", 0.1);
    add_structural_seams(mesh, graph, weight, extrema, seam, progress);
    std::fprintf(stderr, "extrema %d bones %d patches %d\n", result.extrema, result.bones, find_patches(mesh, seam).count);
    progress.begin_phase("local seams", 0.2);
    const LocalSeams local = add_local_seams(mesh, graph, weight, options.max_area_change, seam, progress);
    result.all_developable = local.all_developable;
    result.candidates = static_cast<Index>(find_segments(mesh, seam, hard, weight).size());
    std::fprintf(stderr, "splits %d patches %d segments %d all %d\n", local.splits, find_patches(mesh, seam).count, result.candidates, local.all_developable);
    progress.begin_phase("removing seams", 0.5);
    RemovalOptions removal;
    removal.max_area_change = options.max_area_change;
    if (const char* e = std::getenv("PL")) std::sscanf(e, "%lf,%lf,%lf", &removal.length_power, &removal.size_power, &removal.defect_power);
    const std::vector<double> defect = angle_defects(mesh);
    result.trials = remove_seams({mesh, hard, weight, {}, defect}, removal, seam, progress);
    result.charts = make_chart_map(mesh, find_patches(mesh, seam).label, seam, false);
    std::fprintf(stderr, "trials %d patches %d\n", result.trials, result.charts.count);
    return result;
}

} // namespace devseg
