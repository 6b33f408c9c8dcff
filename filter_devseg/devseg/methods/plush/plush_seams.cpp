#include "devseg/methods/plush/plush_seams.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "devseg/atlas/fragments.h"
#include "devseg/base/option_checks.h"
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
          result_(result), progress_(progress), graph_(build_vertex_graph(mesh_)),
          limb_borders_(mesh_.twin.size(), 0) {
        weigh_edges();
    }

    /// Seams of the open part, with those that there are elsewhere.
    SeamMarks decide(const OpenPart& open, const SeamMarks& hard, double max_area_change) {
        open_ = open;
        hard_ = hard;
        max_area_change_ = max_area_change;
        seam_ = open.seam;
        seam_.resize(mesh_.twin.size(), 0);
        lay_candidates();
        remove();
        return seam_;
    }

    /// The seams, with small patches and thin tongues given to neighbours.
    SeamMarks without_remnants(const SeamMarks& seam, const SeamMarks& hard,
                               double max_area_change) {
        hard_ = hard;
        seam_ = seam;
        PatchTester tester(surface_, {max_area_change, false});
        RemovalOptions removal;
        removal.random_seed = options_.random_seed;
        removal.most_area = tuning.small_remnant;
        removal.least_neck = tuning.narrow_neck;
        const SeamSetting setting{
            surface_, graph_, hard_, weights_.weight, tester, tester, options_.max_iterations};
        progress_.begin_phase("giving tongues away", 0.04);
        const double width = std::max(tuning.thin * std::sqrt(mesh_.total_area),
                                      tuning.least_thin * mean_edge_length(mesh_));
        PatchTester search(surface_, {max_area_change, true});
        const SeamSetting searching{
            surface_, graph_, hard_, weights_.weight, search, search, options_.max_iterations};
        result_.trials += give_tongues_away(searching, width, seam_, progress_);
        progress_.begin_phase("joining patches", 0.04);
        result_.trials += join_patches(setting, removal, seam_, progress_);
        progress_.begin_phase("absorbing remnants", 0.01);
        result_.trials +=
            absorb_remnants(setting, natural_cost(), tuning.small_remnant / 2.0, seam_, progress_);
        progress_.begin_phase("blunting corners", 0.02);
        result_.trials += blunt_acute_corners(setting, seam_, progress_);
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
    void weigh_edges() {
        progress_.begin_phase("finding the skeleton", 0.08);
        if (skeleton_.empty())
            skeleton_ = extract_skeleton(mesh_, progress_);
        BoneWeights bones;
        if (!skeleton_.empty())
            bones = bone_weights(mesh_, skeleton_, progress_);
        result_.bones = static_cast<Index>(skeleton_.bones.size());
        curvature_ = mean_curvature(mesh_);
        weights_ = seam_weights(
            mesh_, {options_.geodesic_weight, options_.skeleton_weight, options_.curvature_weight},
            curvature_, skeleton_, bones, progress_);
        for (std::size_t h = 0; h < surface_.image.size() / 2; ++h) {
            for (std::vector<double>* values : {&weights_.weight, &weights_.stray}) {
                double& image = (*values)[surface_.image[h]];
                (*values)[h] = image = 0.5 * ((*values)[h] + image);
            }
        }
        progress_.update(1.0);
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

    void lay_candidates() {
        progress_.begin_phase("laying seams", 0.08);
        mark_plane();
        const std::vector<Limb> limbs =
            find_limbs(mesh_, graph_, curvature_, limb_tips(), progress_);
        result_.limbs = std::max(result_.limbs, static_cast<Index>(limbs.size()));
        for (const Limb& limb : limbs)
            for (const HalfEdge h : limb_border(mesh_, limb)) {
                mark(mesh_, h, 1, seam_);
                limb_borders_[h] = 1;
            }
        mirror_marks(surface_, limb_borders_);
        add_structural_seams(mesh_, graph_, weights_.weight, extrema_, seam_, progress_);
        clean_patches();
        progress_.begin_phase("cutting patches", 0.15);
        add_local_seams(surface_, graph_, weights_.weight, {max_area_change_, true}, open_.faces,
                        seam_, progress_);
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

    void remove() {
        PatchTester tester(surface_, {max_area_change_, true});
        PatchTester strict(surface_, {tuning.nearly_flat * max_area_change_, true});
        const SeamSetting setting{
            surface_, graph_, hard_, weights_.weight, tester, strict, options_.max_iterations};
        RemovalOptions removal;
        removal.random_seed = options_.random_seed;
        progress_.begin_phase("removing seams", 0.25);
        result_.trials += remove_seams(setting, removal, seam_, progress_);
        progress_.begin_phase("joining patches", 0.15);
        result_.trials += join_patches(setting, removal, seam_, progress_);
        progress_.begin_phase("straightening seams", 0.06);
        straighten_seams(setting, seam_, progress_);
        progress_.begin_phase("joining patches", 0.05);
        removal.most_area = tuning.small_patch;
        removal.least_neck = tuning.narrow_neck;
        result_.trials += join_patches(setting, removal, seam_, progress_);
        progress_.begin_phase("shortening darts", 0.02);
        result_.trials += shorten_darts(setting, seam_, progress_);
    }

    const WorkingSurface& surface_;
    const Mesh& mesh_;
    const PlushOptions& options_;
    Skeleton skeleton_;
    PlushSeams& result_;
    Progress& progress_;
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
    PlushSegmentation on_model(model, options, working.skeleton(), result, progress);
    const std::vector<double> cost = on_model.natural_cost();
    const bool is_model =
        !working.surface().is_symmetric() && working.mesh().face_count() == model.mesh.face_count();
    double bound = (is_model ? tuning.own_margin : tuning.margin) * options.max_area_change;
    SeamMarks seam = working.decide({}, {}, bound);
    const int most_rounds =
        working.surface().is_symmetric() ? tuning.second_thoughts + 1 : tuning.second_thoughts;
    OpenPart part;
    for (int round = 0;; ++round) {
        progress.begin_phase("transferring seams", 0.02);
        SeamMarks carried = transfer_seams(working.mesh(), seam, model.mesh, on_model.graph(),
                                           on_model.stray(), progress);
        cut_corners(model.mesh, carried);
        part = mend_patches(model.mesh, on_model.graph(), cost, std::move(carried),
                            {options.max_area_change, false}, progress);
        if (!part.has_open_faces() || round == most_rounds)
            break;
        const OpenPart again = same_part(working.surface(), seam, model.mesh, part);
        if (!again.has_open_faces())
            break;
        bound *= tuning.tighter;
        seam = working.decide(again, fixed_seams(working.mesh(), again), bound);
    }
    if (part.has_open_faces())
        part.seam = on_model.decide(part, fixed_seams(model.mesh, part), options.max_area_change);
    return on_model.without_remnants(part.seam, {}, options.max_area_change);
}

// The same; patches of large models that are not developable are left to settled_seams.
SeamMarks decide(PlushSegmentation& working, const Mesh& mesh, const PlushOptions& options,
                 PlushSeams& result, Progress& progress) {
    const WorkingSurface model{mesh, {}};
    if (mesh.face_count() <= tuning.large_model)
        return decide_for_model(working, model, options, result, progress);
    const WorkingSurface smaller = plain_working_surface(mesh, tuning.large_model / 2, progress);
    PlushOptions stricter = options;
    stricter.max_area_change *= tuning.own_margin;
    const SeamMarks seam = decide_for_model(working, smaller, stricter, result, progress);
    const PlushSegmentation on_model(model, options, working.skeleton(), result, progress);
    progress.begin_phase("transferring seams", 0.02);
    SeamMarks carried =
        transfer_seams(smaller.mesh, seam, mesh, on_model.graph(), on_model.stray(), progress);
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
    progress.begin_phase("finding symmetry", 0.06);
    std::optional<MirrorPlane> plane;
    if (options.symmetric)
        plane = find_mirror_plane(framed, tuning.symmetric_within, progress);
    const WorkingSurface surface = make_working_surface(framed, plane, hard, progress);
    result.is_symmetric = surface.is_symmetric();
    PlushSegmentation working(surface, options, std::move(skeleton), result, progress);
    SeamMarks seam;
    if (!hard.empty())
        seam = working.without_remnants(working.decide({}, hard, options.max_area_change), hard,
                                        options.max_area_change);
    else
        seam = decide(working, framed, options, result, progress);
    progress.begin_phase("measuring patches", 0.05);
    seam = settled_seams(mesh, std::move(seam), options, result, progress);
    measure_patches(mesh, seam, options.max_area_change, result, progress);
    result.shares = seam_shares(framed, seam, working.guides(), plane, progress);
    return result;
}

} // namespace

PlushSeams segment_plush_seams(const Mesh& mesh, const PlushOptions& options, Skeleton skeleton,
                               const std::vector<std::uint8_t>& hard, Progress& progress) {
    check_range("max_area_change", options.max_area_change, 0.0, 1.0,
                "a number above 0 and at most 1");
    if (options.max_extrema < 0)
        refuse_option("max_extrema", "a number of at least 0", options.max_extrema);
    check_rounds(options.max_iterations, options.random_seed);
    const mesh::CanonicalFrame frame = mesh::canonical_frame(mesh, progress);
    for (Vec3& joint : skeleton.joints)
        joint = frame.to_frame(joint);
    return segment_in_own_frame(mesh::in_frame(mesh, frame, progress), mesh, options,
                                std::move(skeleton), hard, progress);
}

} // namespace devseg::plush
