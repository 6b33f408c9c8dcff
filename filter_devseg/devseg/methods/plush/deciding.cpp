#include "devseg/methods/plush/deciding.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "devseg/atlas/fragments.h"
#include "devseg/methods/plush/limbs.h"
#include "devseg/methods/plush/local_seams.h"
#include "devseg/methods/plush/seam_removal.h"
#include "devseg/methods/plush/seam_smoothing.h"
#include "devseg/methods/plush/thin_tips.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

// Of half-edges as parts of paths that cut patches, and of paths in place of seams.
struct PathCosts {
    std::vector<double> cut;
    std::vector<double> straight;
};

PathCosts path_costs(const Evidence& evidence, const PlushOptions& options) {
    if (options.max_strain > 0.0) {
        const std::vector<double> cost =
            natural_lengths(evidence.surface.mesh, evidence.weights.stray, tuning.natural_cut);
        return {cost, cost};
    }
    const std::vector<double>& weight = evidence.weights.weight;
    std::vector<double> straight = edge_lengths(evidence.surface.mesh);
    for (std::size_t h = 0; h < straight.size(); ++h)
        straight[h] *= natural_factor(tuning.natural_straight, weight[h]);
    return {weight, straight};
}

// Extrema in the open part; those on the mirror image are left to it.
std::vector<Index> limb_tips(const Evidence& evidence, const OpenPart& open) {
    const WorkingSurface& surface = evidence.surface;
    const Mesh& mesh = surface.mesh;
    std::vector<std::uint8_t> is_left_out(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (!open.is_open(face_of(h)) ||
            (surface.is_symmetric() && surface.image[h] < h && !surface.starts_on_plane(h)))
            is_left_out[mesh.origin(h)] = 1;
    std::vector<Index> tips = evidence.extrema;
    tips.erase(
        std::remove_if(tips.begin(), tips.end(), [&](Vertex v) { return is_left_out[v] != 0; }),
        tips.end());
    return tips;
}

void mark_plane(const WorkingSurface& surface, SeamMarks& seam) {
    for (const HalfEdge h : surface.mesh.all_half_edges())
        if (surface.is_on_plane(h))
            mark(surface.mesh, h, 1, seam);
}

// Patches without teeth, the same on both sides; seams inside patches go.
void clean_patches(const WorkingSurface& surface, const OpenPart& open, const SeamMarks& hard,
                   SeamMarks& seam) {
    const Mesh& mesh = surface.mesh;
    mirror_marks(surface, seam);
    std::vector<Index> label =
        atlas::absorb_fragments(mesh, find_patches(mesh, seam).label, tuning.fragment);
    atlas::remove_teeth(mesh, label);
    seam = atlas::make_chart_map(mesh, label, {}, false).seam;
    for (const HalfEdge h : mesh.all_half_edges())
        if (!hard.empty() && (hard[h] != 0 || !open.is_inside(mesh, h)))
            seam[h] = hard[h];
    mark_plane(surface, seam);
    mirror_marks(surface, seam);
}

// Seams along the plane, around limbs and between extrema.
void lay_candidates(Evidence& evidence, const OpenPart& open, const SeamMarks& hard,
                    PlushSeams& result, SeamMarks& seam, Progress& progress) {
    const Mesh& mesh = evidence.surface.mesh;
    mark_plane(evidence.surface, seam);
    const std::vector<Limb> limbs =
        find_limbs(mesh, evidence.graph, evidence.curvature, limb_tips(evidence, open), progress);
    result.limbs = std::max(result.limbs, static_cast<Index>(limbs.size()));
    for (const Limb& limb : limbs)
        for (const HalfEdge h : limb_border(mesh, limb)) {
            mark(mesh, h, 1, seam);
            evidence.limb_borders[h] = 1;
        }
    mirror_marks(evidence.surface, evidence.limb_borders);
    add_structural_seams(mesh, evidence.graph, evidence.weights.weight, evidence.extrema, seam,
                         progress);
    clean_patches(evidence.surface, open, hard, seam);
}

// One pass over the seams of a surface; returns how many trials it took.
struct Pass {
    const char* name;
    double share; // of the time
    std::function<Index(SeamMarks&, Progress&)> run;
};

SeamMarks run(const std::vector<Pass>& passes, SeamMarks seam, PlushSeams& result,
              Progress& progress) {
    for (const Pass& pass : passes) {
        auto part = progress.part(pass.name, pass.share);
        result.trials += pass.run(seam, part);
    }
    return seam;
}

} // namespace

Evidence find_evidence(const WorkingSurface& surface, const PlushOptions& options,
                       Skeleton skeleton, PlushSeams& result, Progress& progress) {
    const Mesh& mesh = surface.mesh;
    if (skeleton.empty())
        skeleton = extract_skeleton(mesh, progress);
    const Laplacian laplacian = make_laplacian(mesh);
    BoneWeights bones;
    if (!skeleton.empty())
        bones = bone_weights(mesh, laplacian, skeleton, progress);
    result.bones = static_cast<Index>(skeleton.bones.size());
    std::vector<double> curvature = mean_curvature(mesh, laplacian);
    SeamWeights weights = seam_weights(
        mesh, {options.geodesic_weight, options.skeleton_weight, options.curvature_weight},
        curvature, skeleton, bones, progress);
    for (std::size_t h = 0; h < surface.image.size() / 2; ++h)
        for (std::vector<double>* values : {&weights.weight, &weights.stray}) {
            double& image = (*values)[surface.image[h]];
            (*values)[h] = image = 0.5 * ((*values)[h] + image);
        }
    progress.update(0.9);
    VertexGraph graph = build_vertex_graph(mesh);
    const auto most = static_cast<Index>(std::sqrt(static_cast<double>(mesh.points.size())));
    std::vector<Index> extrema = find_extrema(graph, conformal_factor(mesh, laplacian),
                                              options.max_extrema > 0 ? options.max_extrema : most);
    result.extrema = std::max(result.extrema, static_cast<Index>(extrema.size()));
    return {surface,
            std::move(graph),
            std::move(skeleton),
            std::move(curvature),
            std::move(weights),
            std::move(extrema),
            SeamMarks(mesh.twin.size(), 0)};
}

SeamGuides guides_of(const Evidence& evidence) {
    const Mesh& mesh = evidence.surface.mesh;
    SeamGuides guides{evidence.skeleton, {}};
    for (const HalfEdge h : mesh.all_half_edges())
        if (evidence.limb_borders[h] != 0)
            guides.limb_borders.push_back(
                {mesh.points[mesh.origin(h)], mesh.points[mesh.target(h)]});
    return guides;
}

std::vector<double> transfer_factors(const Evidence& evidence, const PlushOptions& options) {
    std::vector<double> factors;
    for (const double stray : evidence.weights.stray)
        factors.push_back(natural_factor(
            options.max_strain > 0.0 ? tuning.strained_transfer : tuning.natural_transfer, stray));
    return factors;
}

judge::ClothLimits limits_of(const PlushOptions& options, double share, bool is_search) {
    return {share * options.max_area_change, share * options.max_strain, is_search};
}

SeamMarks decide(Evidence& evidence, const OpenPart& open, const SeamMarks& hard, double share,
                 const PlushOptions& options, PlushSeams& result, Progress& progress) {
    const WorkingSurface& surface = evidence.surface;
    const std::vector<double>& weight = evidence.weights.weight;
    PatchTester tester(surface, limits_of(options, share, true));
    PatchTester strict(surface, limits_of(options, tuning.nearly_flat * share, true));
    const PathCosts costs = path_costs(evidence, options);
    const SeamSetting setting{surface,   evidence.graph, hard,
                              weight,    tester,         strict,
                              costs.cut, costs.straight, options.max_iterations};
    RemovalOptions any_patch;
    any_patch.random_seed = options.random_seed;
    RemovalOptions small_patches = any_patch;
    small_patches.most_area = tuning.small_patch;
    small_patches.least_neck = tuning.narrow_neck;
    const std::vector<Pass> passes{
        {"laying seams", 0.04,
         [&](SeamMarks& seam, Progress& part) {
             lay_candidates(evidence, open, hard, result, seam, part);
             return 0;
         }},
        {"cutting patches", 0.03,
         [&](SeamMarks& seam, Progress& part) {
             add_local_seams(setting, open.faces, seam, part);
             result.candidates +=
                 static_cast<Index>(find_segments(surface.mesh, seam, hard).size());
             return 0;
         }},
        {"removing seams", 0.35,
         [&](auto& seam, auto& part) { return remove_seams(setting, any_patch, seam, part); }},
        {"joining patches", 0.22,
         [&](auto& seam, auto& part) { return join_patches(setting, any_patch, seam, part); }},
        {"straightening seams", 0.25,
         [&](SeamMarks& seam, Progress& part) {
             straighten_seams(setting, seam, part);
             return 0;
         }},
        {"joining patches", 0.03,
         [&](auto& seam, auto& part) { return join_patches(setting, small_patches, seam, part); }},
        {"shortening darts", 0.08,
         [&](auto& seam, auto& part) { return shorten_darts(setting, seam, part); }}};
    SeamMarks seam = open.seam;
    seam.resize(surface.mesh.twin.size(), 0);
    return run(passes, std::move(seam), result, progress);
}

SeamMarks without_remnants(const Evidence& evidence, SeamMarks seam, const SeamMarks& hard,
                           double share, const PlushOptions& options, PlushSeams& result,
                           Progress& progress, bool keep_pairs) {
    const WorkingSurface& surface = evidence.surface;
    const std::vector<double>& weight = evidence.weights.weight;
    PatchTester tester(surface, limits_of(options, share, false));
    PatchTester search(surface, limits_of(options, share, true));
    const std::vector<double> cost =
        natural_lengths(evidence.surface.mesh, evidence.weights.stray, tuning.natural_dart);
    const SeamSetting setting{surface, evidence.graph,        hard, weight, tester, tester, cost,
                              cost,    options.max_iterations};
    const SeamSetting searching{surface, evidence.graph,        hard, weight, search, search, cost,
                                cost,    options.max_iterations};
    RemovalOptions remnants;
    remnants.random_seed = options.random_seed;
    remnants.most_area = tuning.small_patch / 5.0;
    remnants.least_neck = tuning.narrow_neck;
    const double width = std::max(tuning.thin * std::sqrt(surface.mesh.total_area),
                                  tuning.least_thin * mean_edge_length(surface.mesh));
    std::vector<Pass> passes;
    if (!keep_pairs)
        passes = {{"giving tongues away", 0.35,
                   [&](auto& seams, auto& part) {
                       return give_tongues_away(searching, width, seams, part);
                   }},
                  {"joining patches", 0.2, [&](auto& seams, auto& part) {
                       return join_patches(setting, remnants, seams, part);
                   }}};
    const std::vector<Pass> smallest{
        {"absorbing remnants", 0.25,
         [&](auto& seams, auto& part) {
             return absorb_remnants(setting, cost, tuning.small_patch / 10.0, seams, part);
         }},
        {"blunting corners", 0.2,
         [&](auto& seams, auto& part) { return blunt_acute_corners(setting, seams, part); }}};
    passes.insert(passes.end(), smallest.begin(), smallest.end());
    return run(passes, std::move(seam), result, progress);
}

} // namespace devseg::plush
