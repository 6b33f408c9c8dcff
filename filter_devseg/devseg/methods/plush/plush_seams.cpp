#include "devseg/methods/plush/plush_seams.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "devseg/base/parallel.h"
#include "devseg/mesh/canonical_frame.h"
#include "devseg/methods/plush/deciding.h"
#include "devseg/methods/plush/local_seams.h"
#include "devseg/methods/plush/transfer_seams.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

// Material borders are edges of the model: then seams are decided on the model itself. So they are
// on small models without a mirror image: what is saved would be less than what transfer costs.
// Trials by strain take longer.
WorkingSurface make_working_surface(const Mesh& mesh, const std::optional<MirrorPlane>& plane,
                                    const SeamMarks& hard, bool by_strain, Progress& progress) {
    if (!hard.empty())
        return {mesh, {}};
    const Index most = tuning.mirrored_faces * 3 / 2;
    if (plane)
        if (auto surface =
                mirrored_working_surface(mesh, *plane, tuning.mirrored_faces,
                                         by_strain ? most : tuning.mirrored_faces, progress))
            return std::move(*surface);
    if (mesh.face_count() <= (by_strain ? most : tuning.large_model / 4))
        return {mesh, {}};
    return plain_working_surface(mesh, most, progress);
}

// The seams of the model: what is open is decided there, and remnants go.
SeamMarks settled_on_model(Evidence& on_model, OpenPart part, const PlushOptions& options,
                           PlushSeams& result, Progress& progress, bool keep_pairs = false) {
    if (part.has_open_faces()) {
        auto deciding = progress.part(0.6 * progress.left());
        part.seam = decide(on_model, part, fixed_seams(on_model.surface.mesh, part), 1.0, options,
                           result, deciding);
    }
    auto cleaning = progress.part(progress.left());
    return without_remnants(on_model, std::move(part.seam), {}, 1.0, options, result, cleaning,
                            keep_pairs);
}

// Darts for patches of the model that do not keep their limits.
OpenPart mended(const Evidence& on_model, SeamMarks seam, const PlushOptions& options,
                Progress& progress) {
    const Mesh& mesh = on_model.surface.mesh;
    return mend_patches(mesh, on_model.graph,
                        natural_lengths(mesh, on_model.weights.stray, tuning.natural_dart),
                        std::move(seam), limits_of(options, 1.0, false), progress);
}

// The working surface is the model's own half with its mirror image: all is settled there, in
// pairs, and the other half of the model gets the images of the seams.
SeamMarks decide_in_pairs(Evidence& working, Evidence& on_model, const MirroredModel& mirrored,
                          const PlushOptions& options, PlushSeams& result, Progress& progress) {
    auto deciding = progress.part(0.7);
    SeamMarks seam = decide(working, {}, {}, tuning.own_strain, options, result, deciding);
    auto cleaning = progress.part(0.5 * progress.left());
    seam = without_remnants(working, std::move(seam), {}, tuning.own_strain, options, result,
                            cleaning);
    const Mesh& model = on_model.surface.mesh;
    auto transferring = progress.part("transferring seams", 0.1);
    const Mesh placed = fitted_to(model, working.surface.mesh, working.graph, transferring);
    seam = seams_on_model(mirrored, placed, seam, model, on_model.graph, transferring);
    OpenPart part = mended(on_model, absorb_specks(model, std::move(seam)), options, transferring);
    auto settling = progress.part(progress.left());
    return settled_on_model(on_model, std::move(part), options, result, settling, true);
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
    if (by_strain && surface.is_symmetric())
        if (const auto mirrored = mirrored_model(model.mesh, surface.side))
            if (mirrored->surface.mesh.face_count() == surface.mesh.face_count())
                return decide_in_pairs(working, on_model, *mirrored, options, result, progress);
    double share = by_strain  ? (is_model ? tuning.own_strain : tuning.far_strain)
                   : is_model ? tuning.own_margin
                              : tuning.far_margin;
    auto deciding = progress.part(0.5);
    SeamMarks seam = decide(working, {}, {}, share, options, result, deciding);
    // Where the model has two halves, they stay alike only as long as seams are decided on both.
    // By strain, darts and cuts on the model do better.
    const int most_rounds =
        by_strain ? 0 : tuning.second_thoughts + (surface.is_symmetric() ? 1 : 0);
    OpenPart part;
    for (int round = 0;; ++round) {
        auto transferring = progress.part("transferring seams", 0.06);
        part = mended(on_model,
                      transfer_seams(surface.mesh, seam, model.mesh, on_model.graph,
                                     transfer_factors(on_model, options), {}, transferring),
                      options, transferring);
        if (!part.has_open_faces() || round == most_rounds)
            break;
        const OpenPart again = same_part(surface, seam, model.mesh, part);
        if (!again.has_open_faces())
            break;
        share *= tuning.tighter;
        auto deciding_again = progress.part(0.4 * progress.left());
        seam = decide(working, again, fixed_seams(surface.mesh, again), share, options, result,
                      deciding_again);
    }
    auto settling = progress.part(progress.left());
    return settled_on_model(on_model, std::move(part), options, result, settling);
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
                          transfer_factors(on_model, options), {}, transferring);
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
                     mean_curvature(mesh, make_laplacian(mesh)), {}, {}, progress)
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
