#include "devseg/methods/plush/plush_seams.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "devseg/atlas/fragments.h"
#include "devseg/base/parallel.h"
#include "devseg/mesh/canonical_frame.h"
#include "devseg/methods/plush/fit_surface.h"
#include "devseg/methods/plush/limbs.h"
#include "devseg/methods/plush/local_seams.h"
#include "devseg/methods/plush/mend_patches.h"
#include "devseg/methods/plush/seam_smoothing.h"
#include "devseg/methods/plush/thin_tips.h"
#include "devseg/methods/plush/transfer_seams.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

// What seams of one surface are decided by.
struct Evidence {
    const WorkingSurface& surface;
    VertexGraph graph;
    Skeleton skeleton;
    std::vector<double> curvature; // #V
    SeamWeights weights;
    std::vector<Index> extrema;
    SeamMarks limb_borders;   // 3 #F, as they were found
    double least_width = 0.0; // of pieces; 0: they are joined whatever their shape
};

// Material borders are edges of the model: then seams are decided on the model itself. So they are
// on small models without a mirror image: what is saved would be less than what transfer costs.
// Trials by strain take longer.
WorkingSurface make_working_surface(const Mesh& mesh, const std::optional<MirrorPlane>& plane,
                                    const SeamMarks& hard, bool by_strain, Progress& progress) {
    if (!hard.empty())
        return {mesh, {}};
    if (plane)
        if (auto surface = mirrored_working_surface(mesh, *plane, tuning.mirrored_faces, progress))
            return std::move(*surface);
    const Index most = tuning.mirrored_faces * 3 / 2;
    if (mesh.face_count() <= (by_strain ? most : tuning.large_model / 4))
        return {mesh, {}};
    return plain_working_surface(mesh, most, progress);
}

Evidence find_evidence(const WorkingSurface& surface, const PlushOptions& options,
                       Skeleton skeleton, PlushSeams& result, Progress& progress) {
    const Mesh& mesh = surface.mesh;
    if (skeleton.empty())
        skeleton = extract_skeleton(mesh, progress);
    BoneWeights bones;
    if (!skeleton.empty())
        bones = bone_weights(mesh, skeleton, progress);
    result.bones = static_cast<Index>(skeleton.bones.size());
    std::vector<double> curvature = mean_curvature(mesh);
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
    std::vector<Index> extrema = find_extrema(graph, conformal_factor(mesh),
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

// What the seams of the surface follow.
SeamGuides guides_of(const Evidence& evidence) {
    const Mesh& mesh = evidence.surface.mesh;
    SeamGuides guides{evidence.skeleton, {}};
    for (const HalfEdge h : mesh.all_half_edges())
        if (evidence.limb_borders[h] != 0)
            guides.limb_borders.push_back(
                {mesh.points[mesh.origin(h)], mesh.points[mesh.target(h)]});
    return guides;
}

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

// Of half-edges as parts of paths along seams of another surface: factors of their lengths.
std::vector<double> transfer_factors(const Evidence& evidence, const PlushOptions& options) {
    std::vector<double> factors;
    for (const double stray : evidence.weights.stray)
        factors.push_back(natural_factor(
            options.max_strain > 0.0 ? tuning.strained_transfer : tuning.natural_transfer, stray));
    return factors;
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
    remove_teeth(mesh, label);
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

// A share of what the model must keep.
judge::ClothLimits limits_of(const PlushOptions& options, double share, bool is_search) {
    return {share * options.max_area_change, share * options.max_strain, is_search};
}

// Seams of the open part. `hard` has all seams that are not inside of it; or is empty. `share`: of
// the limits.
SeamMarks decide(Evidence& evidence, const OpenPart& open, const SeamMarks& hard, double share,
                 const PlushOptions& options, PlushSeams& result, Progress& progress) {
    const WorkingSurface& surface = evidence.surface;
    const std::vector<double>& weight = evidence.weights.weight;
    PatchTester tester(surface, limits_of(options, share, true), evidence.least_width);
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

// Seams with which small patches and thin tongues are given to neighbours. `share`: as above.
SeamMarks without_remnants(const Evidence& evidence, SeamMarks seam, const SeamMarks& hard,
                           double share, const PlushOptions& options, PlushSeams& result,
                           Progress& progress) {
    const WorkingSurface& surface = evidence.surface;
    const std::vector<double>& weight = evidence.weights.weight;
    PatchTester tester(surface, limits_of(options, share, false), evidence.least_width);
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
    const std::vector<Pass> passes{
        {"giving tongues away", 0.35,
         [&](auto& seams, auto& part) { return give_tongues_away(searching, width, seams, part); }},
        {"joining patches", 0.2,
         [&](auto& seams, auto& part) { return join_patches(setting, remnants, seams, part); }},
        {"absorbing remnants", 0.25,
         [&](auto& seams, auto& part) {
             return absorb_remnants(setting, cost, tuning.small_patch / 10.0, seams, part);
         }},
        {"blunting corners", 0.2,
         [&](auto& seams, auto& part) { return blunt_acute_corners(setting, seams, part); }}};
    return run(passes, std::move(seam), result, progress);
}

// Seams that are decided on the working surface, as smooth lines on the model. Where patches are
// not developable on it and cannot be mended, seams are decided again: with a smaller bound on the
// working surface, and in the end on the model itself.
SeamMarks decide_for_model(Evidence& working, const WorkingSurface& model,
                           const PlushOptions& options, PlushSeams& result, Progress& progress) {
    auto weighing = progress.part("finding the skeleton", 0.02);
    Evidence on_model = find_evidence(model, options, working.skeleton, result, weighing);
    const WorkingSurface& surface = working.surface;
    const bool is_model =
        !surface.is_symmetric() && surface.mesh.face_count() == model.mesh.face_count();
    const bool by_strain = options.max_strain > 0.0;
    // Pieces that a person would sew come in pairs: then all is decided where both images are.
    const bool in_pairs = by_strain && surface.is_symmetric();
    double share = by_strain  ? (is_model || in_pairs ? tuning.own_strain : tuning.far_strain)
                   : is_model ? tuning.own_margin
                              : tuning.far_margin;
    if (in_pairs)
        working.least_width = on_model.least_width = tuning.least_width;
    auto deciding = progress.part(0.5);
    SeamMarks seam = decide(working, {}, {}, share, options, result, deciding);
    WorkingSurface placed = surface;
    if (in_pairs) {
        auto cleaning = progress.part(0.15);
        seam = without_remnants(working, std::move(seam), {}, share, options, result, cleaning);
        placed.mesh = fitted_to(model.mesh, surface.mesh, working.graph, progress);
    }
    const auto transferred = [&](Progress& part) {
        SeamMarks marks = transfer_seams(placed.mesh, seam, model.mesh, on_model.graph,
                                         transfer_factors(on_model, options), part);
        return in_pairs ? absorb_specks(model.mesh, std::move(marks)) : marks;
    };
    const judge::ClothLimits limits = limits_of(options, 1.0, false);
    PatchTester model_tester(model, limits);
    for (int round = 0; in_pairs && round < tuning.paired_darts; ++round) {
        auto mending = progress.part("transferring seams", 0.03);
        if (!mend_in_pairs(
                surface, placed.mesh, working.graph,
                natural_lengths(surface.mesh, working.weights.stray, tuning.natural_dart),
                limits_of(options, share, true), transferred(mending), model_tester, seam, mending))
            break;
    }
    // Where the model has two halves, they stay alike only as long as seams are decided on both.
    // By strain, darts and cuts on the model do better.
    const int most_rounds =
        by_strain ? 0 : tuning.second_thoughts + (surface.is_symmetric() ? 1 : 0);
    OpenPart part;
    for (int round = 0;; ++round) {
        auto transferring = progress.part("transferring seams", 0.06);
        part =
            mend_patches(model.mesh, on_model.graph,
                         natural_lengths(model.mesh, on_model.weights.stray, tuning.natural_dart),
                         transferred(transferring), limits, transferring);
        if (!part.has_open_faces() || round == most_rounds)
            break;
        const OpenPart again = same_part(placed, seam, model.mesh, part);
        if (!again.has_open_faces())
            break;
        share *= tuning.tighter;
        auto deciding_again = progress.part(0.4 * progress.left());
        seam = decide(working, again, fixed_seams(surface.mesh, again), share, options, result,
                      deciding_again);
    }
    if (part.has_open_faces()) {
        auto deciding_on_model = progress.part(0.6 * progress.left());
        part.seam = decide(on_model, part, fixed_seams(model.mesh, part), 1.0, options, result,
                           deciding_on_model);
    }
    auto cleaning = progress.part(progress.left());
    return without_remnants(on_model, std::move(part.seam), {}, 1.0, options, result, cleaning);
}

// The same; large models get the seams of a smaller one, and patches that are not developable are
// left to settled_seams.
SeamMarks decide_for_any(Evidence& working, const Mesh& mesh, const PlushOptions& options,
                         PlushSeams& result, Progress& progress) {
    const WorkingSurface model{mesh, {}};
    if (mesh.face_count() <= tuning.large_model)
        return decide_for_model(working, model, options, result, progress);
    auto coarsening = progress.part("coarsening", 0.1);
    const WorkingSurface smaller = plain_working_surface(mesh, tuning.large_model / 2, coarsening);
    PlushOptions stricter = options;
    stricter.max_area_change *= tuning.own_margin;
    stricter.max_strain *= tuning.own_margin;
    auto deciding = progress.part(0.7);
    const SeamMarks seam = decide_for_model(working, smaller, stricter, result, deciding);
    auto weighing = progress.part("finding the skeleton", 0.1);
    const Evidence on_model = find_evidence(model, options, working.skeleton, result, weighing);
    auto transferring = progress.part("transferring seams", 0.1);
    return transfer_seams(smaller.mesh, seam, mesh, on_model.graph,
                          transfer_factors(on_model, options), transferring);
}

// The seams with which the mesh is flattened. A map that was accepted can fail on a mesh that is
// the same but for rounding.
SeamMarks settled_seams(const Mesh& mesh, SeamMarks seam, const PlushOptions& options,
                        PlushSeams& result, Progress& progress) {
    const WorkingSurface surface{mesh, {}};
    const VertexGraph graph = build_vertex_graph(mesh);
    PatchTester tester(surface, limits_of(options, 1.0, false));
    const std::vector<double> weight =
        seam_weights(mesh, {options.geodesic_weight, 0.0, options.curvature_weight},
                     mean_curvature(mesh), {}, {}, progress)
            .weight;
    OpenPart part = mend_patches(mesh, graph, weight, std::move(seam), tester.limits(), progress);
    result.all_developable =
        add_local_seams({surface, graph, {}, weight, tester, tester, weight, weight},
                        std::move(part.faces), part.seam, progress);
    return part.seam;
}

// The charts, and the change of area in the maps that are accepted.
void measure_patches(const Mesh& mesh, const SeamMarks& seam, const PlushOptions& options,
                     PlushSeams& result, Progress& progress) {
    result.charts = atlas::make_chart_map(mesh, find_patches(mesh, seam).label, seam, false);
    const std::vector<std::vector<Index>> patches = patches_of(mesh, seam);
    std::vector<judge::ClothTrial> trials(patches.size());
    parallel_for(
        result.charts.count,
        [&](int c) {
            trials[c] = judge::try_cloth(mesh, patches[c], seam, limits_of(options, 1.0, false),
                                         true, progress);
        },
        progress);
    result.area_change.assign(mesh.faces.size(), 0.0);
    for (Index c = 0; c < result.charts.count; ++c) {
        const judge::ClothTrial& trial = trials[at(c)];
        if (!trial.accepted)
            result.failed.push_back(c);
        result.max_area_change = std::max(result.max_area_change, trial.area_change);
        result.strain.take_worse(trial.strain);
        for (std::size_t i = 0; i < trial.change.size(); ++i)
            result.area_change[trial.face[i]] = std::abs(trial.change[i]);
    }
    const std::vector<Index> degree = seam_degrees(mesh, seam);
    result.darts = static_cast<Index>(std::count(degree.begin(), degree.end(), 1));
}

// Decisions are close to their bounds, so that rounding of a rotated model could change them:
// `framed`, and the skeleton, are in the canonical frame. `mesh` is as it is flattened later.
PlushSeams segment_in_canonical_frame(const Mesh& framed, const Mesh& mesh,
                                      const PlushOptions& options, Skeleton skeleton,
                                      const SeamMarks& hard, Progress& progress) {
    PlushSeams result;
    auto finding = progress.part("finding symmetry", 0.1);
    std::optional<MirrorPlane> plane;
    if (options.symmetric)
        plane = find_mirror_plane(framed, tuning.symmetric_within, finding);
    const WorkingSurface surface =
        make_working_surface(framed, plane, hard, options.max_strain > 0.0, finding);
    result.is_symmetric = surface.is_symmetric();
    auto weighing = progress.part("finding the skeleton", 0.04);
    Evidence working = find_evidence(surface, options, std::move(skeleton), result, weighing);
    auto deciding = progress.part(0.8);
    SeamMarks seam;
    if (!hard.empty()) {
        auto first = deciding.part(0.8);
        seam = decide(working, {}, hard, 1.0, options, result, first);
        auto cleaning = deciding.part(0.2);
        seam = without_remnants(working, std::move(seam), hard, 1.0, options, result, cleaning);
    } else {
        seam = decide_for_any(working, framed, options, result, deciding);
    }
    auto settling = progress.part("measuring patches", 0.5 * progress.left());
    seam = settled_seams(mesh, std::move(seam), options, result, settling);
    auto measuring = progress.part("measuring patches", progress.left());
    measure_patches(mesh, seam, options, result, measuring);
    result.shares = seam_shares(framed, seam, guides_of(working), plane, progress);
    return result;
}

} // namespace

OptionRanges<PlushOptions> PlushOptions::ranges() {
    using O = PlushOptions;
    return with_rounds<O>({{&O::max_area_change, {"max_area_change", 0.01, 1.0}},
                           {&O::max_strain, {"max_strain", 0.0, 1.0}},
                           {&O::geodesic_weight, {"geodesic_weight", 0.0, 10.0}},
                           {&O::skeleton_weight, {"skeleton_weight", 0.0, 10.0}},
                           {&O::curvature_weight, {"curvature_weight", 0.0, 10.0}},
                           {&O::max_extrema, {"max_extrema", 0, 1e6}}});
}

PlushSeams segment_plush_seams(const Mesh& mesh, const PlushOptions& options, Skeleton skeleton,
                               const std::vector<std::uint8_t>& hard, Progress& progress) {
    check_ranges(options);
    const mesh::CanonicalFrame frame = mesh::canonical_frame(mesh, progress);
    for (Vec3& joint : skeleton.joints)
        joint = frame.to_frame(joint);
    return segment_in_canonical_frame(mesh::in_frame(mesh, frame, progress), mesh, options,
                                      std::move(skeleton), hard, progress);
}

} // namespace devseg::plush
