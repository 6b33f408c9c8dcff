#include "devseg/methods/plush/plush_seams.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "devseg/atlas/fragments.h"
#include "devseg/base/parallel.h"
#include "devseg/mesh/canonical_frame.h"
#include "devseg/methods/plush/acute_corners.h"
#include "devseg/methods/plush/limbs.h"
#include "devseg/methods/plush/local_seams.h"
#include "devseg/methods/plush/mend_patches.h"
#include "devseg/methods/plush/patch_trial.h"
#include "devseg/methods/plush/seam_removal.h"
#include "devseg/methods/plush/seam_smoothing.h"
#include "devseg/methods/plush/tongues.h"
#include "devseg/methods/plush/transfer_seams.h"
#include "devseg/methods/plush/tuning.h"
#include "devseg/methods/plush/working_surface.h"

namespace devseg::plush {

namespace {

// Material borders are edges of the model: then seams are decided on the model itself.
WorkingSurface make_working_surface(const Mesh& mesh, const std::optional<MirrorPlane>& plane,
                                    const SeamMarks& hard, Progress& progress) {
    if (!hard.empty())
        return {mesh, {}};
    if (plane)
        if (auto surface = mirrored_working_surface(mesh, *plane, tuning.mirrored_faces, progress))
            return std::move(*surface);
    if (mesh.face_count() <= tuning.large_model / 4)
        return {mesh, {}};
    return plain_working_surface(mesh, tuning.mirrored_faces * 3 / 2, progress);
}

// The steps of the method on one surface, with what they share. `hard` has all seams that are not
// inside the open part.
class PlushSegmentation {
public:
    PlushSegmentation(const WorkingSurface& surface, const PlushOptions& options, Skeleton skeleton,
                      PlushSeams& result, Progress& progress)
        : surface_(surface), mesh_(surface.mesh), options_(options), skeleton_(std::move(skeleton)),
          result_(result), graph_(build_vertex_graph(mesh_)), limb_borders_(mesh_.twin.size(), 0) {
        weigh_edges(progress);
    }

    /// Seams of the open part, with those that there are elsewhere.
    SeamMarks decide(const OpenPart& open, const SeamMarks& hard, double max_area_change,
                     Progress& progress) {
        open_ = open;
        hard_ = hard;
        max_area_change_ = max_area_change;
        seam_ = open.seam;
        seam_.resize(mesh_.twin.size(), 0);
        lay_candidates(progress);
        remove(progress);
        return seam_;
    }

    /// The seams, with small patches and thin tongues given to neighbours.
    SeamMarks without_remnants(const SeamMarks& seam, const SeamMarks& hard, double max_area_change,
                               Progress& progress) {
        hard_ = hard;
        seam_ = seam;
        PatchTester tester(surface_, {max_area_change, false});
        RemovalOptions removal;
        removal.random_seed = options_.random_seed;
        removal.most_area = tuning.small_remnant;
        removal.least_neck = tuning.narrow_neck;
        const SeamSetting setting{
            surface_, graph_, hard_, weights_.weight, tester, tester, options_.max_iterations};
        auto giving = progress.part("giving tongues away", 0.35);
        const double width = std::max(tuning.thin * std::sqrt(mesh_.total_area),
                                      tuning.least_thin * mean_edge_length(mesh_));
        PatchTester search(surface_, {max_area_change, true});
        const SeamSetting searching{
            surface_, graph_, hard_, weights_.weight, search, search, options_.max_iterations};
        result_.trials += give_tongues_away(searching, width, seam_, giving);
        auto joining = progress.part("joining patches", 0.2);
        result_.trials += join_patches(setting, removal, seam_, joining);
        auto absorbing = progress.part("absorbing remnants", 0.25);
        result_.trials +=
            absorb_remnants(setting, natural_cost(), tuning.small_remnant / 2.0, seam_, absorbing);
        auto blunting = progress.part("blunting corners", 0.2);
        result_.trials += blunt_acute_corners(setting, seam_, blunting);
        return seam_;
    }

    const Mesh& mesh() const { return mesh_; }
    const VertexGraph& graph() const { return graph_; }
    const std::vector<double>& stray() const { return weights_.stray; }

    /// Of half-edges as parts of darts: their lengths, less where seams look natural.
    std::vector<double> natural_cost() const {
        std::vector<double> cost;
        for (const HalfEdge h : mesh_.all_half_edges())
            cost.push_back(mesh_.edge_length(h) *
                           natural_factor(tuning.natural_dart, weights_.stray[h]));
        return cost;
    }

    const Skeleton& skeleton() const { return skeleton_; }

    /// What the seams of this surface follow.
    SeamGuides guides() const {
        SeamGuides guides{skeleton_, {}};
        for (const HalfEdge h : mesh_.all_half_edges())
            if (limb_borders_[h] != 0)
                guides.limb_borders.push_back(
                    {mesh_.points[mesh_.origin(h)], mesh_.points[mesh_.target(h)]});
        return guides;
    }

    const WorkingSurface& surface() const { return surface_; }

private:
    void weigh_edges(Progress& progress) {
        if (skeleton_.empty())
            skeleton_ = extract_skeleton(mesh_, progress);
        BoneWeights bones;
        if (!skeleton_.empty())
            bones = bone_weights(mesh_, skeleton_, progress);
        result_.bones = static_cast<Index>(skeleton_.bones.size());
        curvature_ = mean_curvature(mesh_);
        weights_ = seam_weights(
            mesh_, {options_.geodesic_weight, options_.skeleton_weight, options_.curvature_weight},
            curvature_, skeleton_, bones, progress);
        for (std::size_t h = 0; h < surface_.image.size() / 2; ++h) {
            for (std::vector<double>* values : {&weights_.weight, &weights_.stray}) {
                double& image = (*values)[surface_.image[h]];
                (*values)[h] = image = 0.5 * ((*values)[h] + image);
            }
        }
        progress.update(0.9);
        const auto most = static_cast<Index>(std::sqrt(static_cast<double>(mesh_.points.size())));
        extrema_ = find_extrema(graph_, conformal_factor(mesh_),
                                options_.max_extrema > 0 ? options_.max_extrema : most);
        result_.extrema = std::max(result_.extrema, static_cast<Index>(extrema_.size()));
    }

    // Those in the open part; those on the mirror image are left to it.
    std::vector<Index> limb_tips() const {
        std::vector<std::uint8_t> is_left_out(mesh_.points.size(), 0);
        for (const HalfEdge h : mesh_.all_half_edges())
            if (!open_.is_open(h / 3))
                is_left_out[mesh_.origin(h)] = 1;
        for (HalfEdge h = mesh_.half_edge_count() / 2;
             h < mesh_.half_edge_count() && surface_.is_symmetric(); ++h)
            if (!surface_.starts_on_plane(h))
                is_left_out[mesh_.origin(h)] = 1;
        std::vector<Index> first;
        for (const Vertex v : extrema_)
            if (is_left_out[v] == 0)
                first.push_back(v);
        return first;
    }

    void lay_candidates(Progress& progress) {
        auto laying = progress.part("laying seams", 0.04);
        mark_plane();
        const std::vector<Limb> limbs = find_limbs(mesh_, graph_, curvature_, limb_tips(), laying);
        result_.limbs = std::max(result_.limbs, static_cast<Index>(limbs.size()));
        for (const Limb& limb : limbs)
            for (const HalfEdge h : limb_border(mesh_, limb)) {
                mark(mesh_, h, 1, seam_);
                limb_borders_[h] = 1;
            }
        mirror_marks(surface_, limb_borders_);
        add_structural_seams(mesh_, graph_, weights_.weight, extrema_, seam_, laying);
        clean_patches();
        auto cutting = progress.part("cutting patches", 0.03);
        add_local_seams(surface_, graph_, weights_.weight, {max_area_change_, true}, open_.faces,
                        seam_, cutting);
        result_.candidates +=
            static_cast<Index>(find_segments(mesh_, seam_, hard_, weights_.weight).size());
    }

    void mark_plane() {
        for (const HalfEdge h : mesh_.all_half_edges())
            if (surface_.is_on_plane(h))
                mark(mesh_, h, 1, seam_);
    }

    // Patches without teeth, the same on both sides; seams inside patches go.
    void clean_patches() {
        mirror_marks(surface_, seam_);
        std::vector<Index> label =
            atlas::absorb_fragments(mesh_, find_patches(mesh_, seam_).label, tuning.fragment);
        remove_teeth(mesh_, label);
        seam_ = atlas::make_chart_map(mesh_, label, {}, false).seam;
        for (const HalfEdge h : mesh_.all_half_edges())
            if (!hard_.empty() && (hard_[h] != 0 || !open_.is_inside(mesh_, h)))
                seam_[h] = hard_[h];
        mark_plane();
        mirror_marks(surface_, seam_);
    }

    void remove(Progress& progress) {
        PatchTester tester(surface_, {max_area_change_, true});
        PatchTester strict(surface_, {tuning.nearly_flat * max_area_change_, true});
        const SeamSetting setting{
            surface_, graph_, hard_, weights_.weight, tester, strict, options_.max_iterations};
        RemovalOptions removal;
        removal.random_seed = options_.random_seed;
        auto removing = progress.part("removing seams", 0.35);
        result_.trials += remove_seams(setting, removal, seam_, removing);
        auto joining = progress.part("joining patches", 0.22);
        result_.trials += join_patches(setting, removal, seam_, joining);
        auto straightening = progress.part("straightening seams", 0.25);
        straighten_seams(setting, seam_, straightening);
        auto joining_small = progress.part("joining patches", 0.03);
        removal.most_area = tuning.small_patch;
        removal.least_neck = tuning.narrow_neck;
        result_.trials += join_patches(setting, removal, seam_, joining_small);
        auto shortening = progress.part("shortening darts", 0.08);
        result_.trials += shorten_darts(setting, seam_, shortening);
    }

    const WorkingSurface& surface_;
    const Mesh& mesh_;
    const PlushOptions& options_;
    Skeleton skeleton_;
    PlushSeams& result_;
    const VertexGraph graph_;
    std::vector<double> curvature_; // #V
    SeamWeights weights_;
    std::vector<Index> extrema_;
    SeamMarks limb_borders_; // 3 #F, as they were found
    OpenPart open_;
    SeamMarks hard_; // 3 #F or empty
    double max_area_change_ = 0.0;
    SeamMarks seam_;
};

// The charts, and the change of area in the maps that are accepted.
void measure_patches(const Mesh& mesh, const SeamMarks& seam, double max_area_change,
                     PlushSeams& result, Progress& progress) {
    result.charts = atlas::make_chart_map(mesh, find_patches(mesh, seam).label, seam, false);
    const atlas::ChartFaces groups = atlas::group_faces(result.charts);
    std::vector<PatchTrial> trials(at(result.charts.count));
    parallel_for(
        result.charts.count,
        [&](int c) {
            const std::vector<Index> faces{groups.faces.begin() + groups.begin[c],
                                           groups.faces.begin() + groups.begin[at(c) + 1]};
            trials[c] = try_patch(mesh, faces, seam, {max_area_change, false}, true, progress);
        },
        progress);
    result.area_change.assign(mesh.faces.size(), 0.0);
    for (const PatchTrial& trial : trials) {
        result.max_area_change = std::max(result.max_area_change, trial.area_change);
        result.all_developable = result.all_developable && trial.accepted;
        for (std::size_t i = 0; i < trial.change.size(); ++i)
            result.area_change[trial.face[i]] = std::abs(trial.change[i]);
    }
    for (const Index degree : seam_degrees(mesh, seam))
        result.darts += degree == 1 ? 1 : 0;
}

// Seams that are decided on the working surface, as smooth lines on the model. Where patches are
// not developable on it and cannot be mended, seams are decided again: with a smaller bound on the
// working surface, and in the end on the model itself.
SeamMarks decide_for_model(PlushSegmentation& working, const WorkingSurface& model,
                           const PlushOptions& options, PlushSeams& result, Progress& progress) {
    auto weighing = progress.part("finding the skeleton", 0.02);
    PlushSegmentation on_model(model, options, working.skeleton(), result, weighing);
    const std::vector<double> cost = on_model.natural_cost();
    const bool is_model =
        !working.surface().is_symmetric() && working.mesh().face_count() == model.mesh.face_count();
    double bound = (is_model ? tuning.own_margin : tuning.margin) * options.max_area_change;
    auto deciding = progress.part(0.5);
    SeamMarks seam = working.decide({}, {}, bound, deciding);
    const int most_rounds =
        working.surface().is_symmetric() ? tuning.second_thoughts + 1 : tuning.second_thoughts;
    OpenPart part;
    for (int round = 0;; ++round) {
        auto transferring = progress.part("transferring seams", 0.06);
        SeamMarks carried = transfer_seams(working.mesh(), seam, model.mesh, on_model.graph(),
                                           on_model.stray(), transferring);
        cut_corners(model.mesh, carried);
        part = mend_patches(model.mesh, on_model.graph(), cost, std::move(carried),
                            {options.max_area_change, false}, transferring);
        if (!part.has_open_faces() || round == most_rounds)
            break;
        const OpenPart again = same_part(working.surface(), seam, model.mesh, part);
        if (!again.has_open_faces())
            break;
        bound *= tuning.tighter;
        auto second = progress.part(0.4 * progress.left());
        seam = working.decide(again, fixed_seams(working.mesh(), again), bound, second);
    }
    if (part.has_open_faces()) {
        auto last = progress.part(0.6 * progress.left());
        part.seam =
            on_model.decide(part, fixed_seams(model.mesh, part), options.max_area_change, last);
    }
    auto cleaning = progress.part(progress.left());
    return on_model.without_remnants(part.seam, {}, options.max_area_change, cleaning);
}

// The same; patches of large models that are not developable are left to settled_seams.
SeamMarks decide(PlushSegmentation& working, const Mesh& mesh, const PlushOptions& options,
                 PlushSeams& result, Progress& progress) {
    const WorkingSurface model{mesh, {}};
    if (mesh.face_count() <= tuning.large_model)
        return decide_for_model(working, model, options, result, progress);
    auto coarsening = progress.part("coarsening", 0.1);
    const WorkingSurface smaller = plain_working_surface(mesh, tuning.large_model / 2, coarsening);
    PlushOptions stricter = options;
    stricter.max_area_change *= tuning.own_margin;
    auto deciding = progress.part(0.7);
    const SeamMarks seam = decide_for_model(working, smaller, stricter, result, deciding);
    auto weighing = progress.part("finding the skeleton", 0.1);
    const PlushSegmentation on_model(model, options, working.skeleton(), result, weighing);
    auto transferring = progress.part("transferring seams", 0.1);
    SeamMarks carried =
        transfer_seams(smaller.mesh, seam, mesh, on_model.graph(), on_model.stray(), transferring);
    cut_corners(mesh, carried);
    return carried;
}

// The seams with which the mesh is flattened. A map that was accepted can fail on a mesh that is
// the same but for rounding.
SeamMarks settled_seams(const Mesh& mesh, SeamMarks seam, const PlushOptions& options,
                        PlushSeams& result, Progress& progress) {
    const VertexGraph graph = build_vertex_graph(mesh);
    const PatchLimits limits{options.max_area_change, false};
    const SeamWeights weights =
        seam_weights(mesh, {options.geodesic_weight, 0.0, options.curvature_weight},
                     mean_curvature(mesh), {}, {}, progress);
    OpenPart part = mend_patches(mesh, graph, weights.weight, std::move(seam), limits, progress);
    result.all_developable = add_local_seams({mesh, {}}, graph, weights.weight, limits,
                                             std::move(part.faces), part.seam, progress);
    return part.seam;
}

// What is measured comes near to bounds, and what follows from it would depend on how the model is
// turned: `framed`, and the skeleton, are in the model's own frame. `mesh` is as it is flattened
// later.
PlushSeams segment_in_own_frame(const Mesh& framed, const Mesh& mesh, const PlushOptions& options,
                                Skeleton skeleton, const SeamMarks& hard, Progress& progress) {
    PlushSeams result;
    auto finding = progress.part("finding symmetry", 0.1);
    std::optional<MirrorPlane> plane;
    if (options.symmetric)
        plane = find_mirror_plane(framed, tuning.symmetric_within, finding);
    const WorkingSurface surface = make_working_surface(framed, plane, hard, finding);
    result.is_symmetric = surface.is_symmetric();
    auto weighing = progress.part("finding the skeleton", 0.04);
    PlushSegmentation working(surface, options, std::move(skeleton), result, weighing);
    auto deciding = progress.part(0.8);
    SeamMarks seam;
    if (!hard.empty()) {
        auto first = deciding.part(0.8);
        seam = working.decide({}, hard, options.max_area_change, first);
        auto cleaning = deciding.part(0.2);
        seam = working.without_remnants(seam, hard, options.max_area_change, cleaning);
    } else {
        seam = decide(working, framed, options, result, deciding);
    }
    auto settling = progress.part("measuring patches", 0.5 * progress.left());
    seam = settled_seams(mesh, std::move(seam), options, result, settling);
    auto measuring = progress.part("measuring patches", progress.left());
    measure_patches(mesh, seam, options.max_area_change, result, measuring);
    result.shares = seam_shares(framed, seam, working.guides(), plane, progress);
    return result;
}

} // namespace

OptionRanges<PlushOptions> PlushOptions::ranges() {
    using O = PlushOptions;
    return with_rounds<O>({{&O::max_area_change, {"max_area_change", 0.01, 1.0}},
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
    return segment_in_own_frame(mesh::in_frame(mesh, frame, progress), mesh, options,
                                std::move(skeleton), hard, progress);
}

} // namespace devseg::plush
