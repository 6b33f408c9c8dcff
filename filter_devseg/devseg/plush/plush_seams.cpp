#include "devseg/plush/plush_seams.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "devseg/parallel.h"
#include "devseg/plush/limbs.h"
#include "devseg/plush/local_seams.h"
#include "devseg/plush/patch_trial.h"
#include "devseg/plush/seam_removal.h"
#include "devseg/plush/seam_smoothing.h"
#include "devseg/plush/symmetry.h"
#include "devseg/segment/fragments.h"
#include "devseg/segment/option_checks.h"

namespace devseg {

namespace {

constexpr double symmetric_enough = 0.03; // of the diagonal
constexpr double fragment = 4e-4;         // of the surface: smaller parts go to a neighbour
// Once seams are straight, patches up to this share of the surface are joined along narrower necks.
constexpr double small_patch = 0.1;
constexpr double narrow_neck = 0.15;

// The steps of the method on one surface, with what they share.
class PlushSegmentation {
public:
    PlushSegmentation(const Mesh& mesh, const PlushOptions& options, const SeamMarks& hard,
                      Progress& progress)
        : mesh_(mesh), options_(options), hard_(hard), progress_(progress),
          graph_(build_vertex_graph(mesh)), seam_(mesh.twin.size(), 0) {}

    PlushSeams run(Skeleton skeleton) {
        weigh_edges(std::move(skeleton));
        find_symmetry();
        lay_candidates();
        const SeamSetting setting{
            mesh_, hard_, weight_, mirror_, options_.max_area_change, options_.max_iterations};
        remove(setting);
        finish();
        return std::move(result_);
    }

private:
    void weigh_edges(Skeleton skeleton) {
        progress_.begin_phase("finding the skeleton", 0.08);
        if (skeleton.empty())
            skeleton = extract_skeleton(mesh_, progress_);
        BoneWeights bones;
        if (!skeleton.empty())
            bones = bone_weights(mesh_, skeleton, progress_);
        result_.bones = static_cast<Index>(skeleton.bones.size());
        curvature_ = mean_curvature(mesh_);
        weight_ = seam_weights(
            mesh_, {options_.geodesic_weight, options_.skeleton_weight, options_.curvature_weight},
            curvature_, skeleton, bones);
        progress_.update(1.0);
        const auto most = static_cast<Index>(std::sqrt(static_cast<double>(mesh_.points.size())));
        extrema_ = find_extrema(graph_, conformal_factor(mesh_),
                                options_.max_extrema > 0 ? options_.max_extrema : most);
        result_.extrema = static_cast<Index>(extrema_.size());
    }

    void find_symmetry() {
        progress_.begin_phase("finding symmetry", 0.04);
        const auto plane = options_.symmetric
                               ? find_mirror_plane(mesh_, symmetric_enough, progress_)
                               : std::nullopt;
        result_.is_symmetric = plane.has_value();
        if (!plane)
            return;
        side_ = sides_of(mesh_, *plane);
        image_ = mirror_faces(mesh_, *plane, side_);
        mirror_ = mirror_vertices(mesh_, *plane);
    }

    void lay_candidates() {
        progress_.begin_phase("laying seams", 0.08);
        add_middle_line(seam_);
        const std::vector<Limb> limbs = find_limbs(mesh_, graph_, curvature_, extrema_, progress_);
        result_.limbs = static_cast<Index>(limbs.size());
        add_limb_seams(mesh_, limbs, seam_);
        add_structural_seams(mesh_, graph_, weight_, extrema_, seam_, progress_);
        mirror_seams();
        progress_.begin_phase("cutting patches", 0.2);
        result_.all_developable = cut_patches();
        if (result_.is_symmetric) {
            mirror_seams();
            result_.all_developable = cut_patches();
        }
        result_.candidates = static_cast<Index>(find_segments(mesh_, seam_, hard_, weight_).size());
    }

    void add_middle_line(SeamMarks& seam) const {
        for (Index h = 0; h < mesh_.half_edge_count() && !side_.empty(); ++h)
            if (mesh_.twin[at(h)] >= 0 && side_[at(h / 3)] != side_[at(mesh_.twin[at(h)] / 3)])
                seam[at(h)] = 1;
    }

    bool cut_patches() {
        return add_local_seams(mesh_, graph_, weight_, options_.max_area_change, seam_, progress_)
            .all_developable;
    }

    // Patches without teeth, those of one side mirrored to the other; seams inside patches go.
    void mirror_seams() {
        add_middle_line(seam_);
        const FaceComponents patches = find_patches(mesh_, seam_);
        std::vector<Index> label = patches.label;
        for (std::size_t f = 0; f < side_.size(); ++f)
            if (side_[f] != 0)
                label[f] = patches.count + patches.label[at(image_[f])];
        label = absorb_fragments(mesh_, label, fragment);
        remove_teeth(mesh_, label);
        seam_ = make_chart_map(mesh_, label, {}, false).seam;
        for (std::size_t h = 0; h < hard_.size(); ++h)
            if (hard_[h] != 0)
                seam_[h] = 1;
    }

    void remove(const SeamSetting& setting) {
        progress_.begin_phase("removing seams", 0.25);
        RemovalOptions removal;
        removal.random_seed = options_.random_seed;
        result_.trials += remove_seams(setting, removal, seam_, progress_);
        progress_.begin_phase("joining patches", 0.15);
        result_.trials += join_patches(setting, removal, seam_, progress_);
        progress_.begin_phase("straightening seams", 0.1);
        straighten_seams(setting, graph_, seam_, progress_);
        progress_.begin_phase("joining patches", 0.05);
        removal.most_area = small_patch;
        removal.least_neck = narrow_neck;
        result_.trials += join_patches(setting, removal, seam_, progress_);
        progress_.begin_phase("shortening darts", 0.03);
        result_.trials += shorten_darts(setting, seam_, progress_);
        // Nothing should be left to cut here; noise can make a patch fail that was accepted before.
        result_.all_developable = cut_patches();
    }

    // The charts, and the change of area in the maps that were accepted.
    void finish() {
        progress_.begin_phase("measuring patches", 0.02);
        result_.charts = make_chart_map(mesh_, find_patches(mesh_, seam_).label, seam_, false);
        const ChartFaces groups = group_faces(result_.charts);
        std::vector<PatchTrial> trials(at(result_.charts.count));
        parallel_for(
            result_.charts.count,
            [&](int c) {
                const std::vector<Index> faces{groups.faces.begin() + groups.begin[at(c)],
                                               groups.faces.begin() + groups.begin[at(c) + 1]};
                trials[at(c)] =
                    try_patch(mesh_, faces, seam_, options_.max_area_change, true, progress_);
            },
            progress_);
        result_.area_change.assign(mesh_.faces.size(), 0.0);
        for (const PatchTrial& trial : trials) {
            result_.max_area_change = std::max(result_.max_area_change, trial.area_change);
            result_.all_developable = result_.all_developable && trial.accepted;
            for (std::size_t i = 0; i < trial.change.size(); ++i)
                result_.area_change[at(trial.face[i])] = std::abs(trial.change[i]);
        }
        for (const Index degree : seam_degrees(mesh_, seam_))
            result_.darts += degree == 1 ? 1 : 0;
    }

    const Mesh& mesh_;
    const PlushOptions& options_;
    const SeamMarks& hard_;
    Progress& progress_;
    const VertexGraph graph_;
    std::vector<double> curvature_; // #V
    std::vector<double> weight_;    // 3 #F
    std::vector<Index> extrema_;
    std::vector<std::uint8_t> side_; // #F; empty without symmetry, as the next two
    std::vector<Index> image_;       // #F
    std::vector<Index> mirror_;      // #V
    SeamMarks seam_;
    PlushSeams result_;
};

} // namespace

PlushSeams segment_plush_seams(const Mesh& mesh, const PlushOptions& options, Skeleton skeleton,
                               const std::vector<std::uint8_t>& hard, Progress& progress) {
    check_range("max_area_change", options.max_area_change, 0.0, 1.0,
                "a number above 0 and at most 1");
    if (options.max_extrema < 0)
        refuse_option("max_extrema", "a number of at least 0", options.max_extrema);
    check_rounds(options.max_iterations, options.random_seed);
    return PlushSegmentation(mesh, options, hard, progress).run(std::move(skeleton));
}

} // namespace devseg
