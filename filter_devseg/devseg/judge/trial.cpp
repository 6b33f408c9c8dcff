#include "devseg/judge/trial.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "devseg/atlas/disks.h"
#include "devseg/flatten/energy/laplacian.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/flatten/maps/arap.h"
#include "devseg/flatten/maps/tutte.h"
#include "devseg/flatten/maps/unfold.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/plane/overlap.h"

namespace devseg::judge {

namespace {

struct Tuning {
    // Rounds stop when ten of them gain less than this share of the excess that is compared with,
    // and never before they gain less than this share of the energy.
    double share_of_excess = 1e-3;
    double coarsest = 1e-5;
    int few_rounds = 40;
    int many_rounds = 200;
    double near_excess = 10.0; // over the wanted one: a start that is farther is not near
    // Of the root of the area: parts that overlap by more in a map that is near do not come apart.
    double deep_overlap = 1e-3;
};
constexpr Tuning tuning;

// Flattens one chart on trial.
class Trial {
public:
    Trial(const atlas::ChartSurface& surface, const flatten::FlatteningProblem& problem,
          const TrialEffort& effort, const Progress& progress)
        : surface_(surface), problem_(problem), effort_(effort), progress_(progress),
          excess_(effort.wanted_l2 * effort.wanted_l2 - 1.0) {}

    // Near an isometry l2² − 1 is 1.5 to 2 times the excess of the symmetric Dirichlet energy over
    // 1, depending on how much of the distortion is shear: an energy whose excess is that of the
    // wanted l2² is hopeless; so is such an energy of stitched faces, which is about the same where
    // it is small. Empty where there is no map worth looking at.
    std::vector<Vec2> flatten(const std::vector<Vec2>& turns) {
        std::vector<Vec2> start;
        if (turns.empty() && effort_.only_near)
            return {};
        laplacian_.emplace(problem_);
        if (!turns.empty()) {
            const auto stitched = stitch(turns);
            if (stitched && stitched->empty())
                return {};
            start = stitched.value_or(std::vector<Vec2>());
        }
        if (start.empty() || flatten::count_flips(problem_, start) > 0) {
            if (effort_.only_near)
                return {};
            start = flatten::simple_map(problem_);
        } else if (effort_.only_near && !is_near(start)) {
            return {};
        }
        if (effort_.only_apart && is_near(start) &&
            flatten::overlaps_itself(surface_, start,
                                     tuning.deep_overlap * std::sqrt(problem_.total_area)))
            return {};
        std::vector<Vec2> uv = polish(start);
        flatten::scale_to_area(problem_, uv);
        return uv;
    }

private:
    std::optional<std::vector<Vec2>> stitch(const std::vector<Vec2>& turns) const {
        flatten::StitchOptions options;
        if (effort_.give_up)
            options.give_up_energy = excess_;
        return flatten::attempt(
            [&] { return std::optional(flatten::stitch(problem_, *laplacian_, turns, options)); });
    }

    // Parts that overlap in a map so near to the best one are not going to come apart.
    bool is_near(const std::vector<Vec2>& start) const {
        return flatten::symmetric_dirichlet_energy(problem_, start) - 1.0 <=
               tuning.near_excess * excess_;
    }

    std::vector<Vec2> polish(const std::vector<Vec2>& start) const {
        flatten::SymmetricDirichletOptions options;
        const double gain = tuning.share_of_excess * excess_;
        options.relative_tolerance = std::min(gain, tuning.coarsest);
        options.max_iterations = gain < tuning.coarsest ? tuning.many_rounds : tuning.few_rounds;
        if (effort_.give_up)
            options.give_up_energy = 1.0 + excess_;
        options.laplacian = &*laplacian_;
        return flatten::minimise_symmetric_dirichlet(problem_, start, options, progress_).uv;
    }

    const atlas::ChartSurface& surface_;
    const flatten::FlatteningProblem& problem_;
    const TrialEffort& effort_;
    const Progress& progress_;
    std::optional<flatten::Laplacian> laplacian_; // needed where there is a start
    double excess_;                               // wanted
};

// Faces that are stretched more than all faces around them.
std::vector<Index> local_maxima(const atlas::ChartSurface& surface,
                                const std::vector<double>& stretch) {
    std::vector<Index> maxima;
    for (const Face f : surface.all_faces()) {
        bool highest = true;
        for (const HalfEdge h : half_edges_of(f))
            mesh::visit_star(surface.twin, h, [&](HalfEdge k) {
                const Face g = face_of(k);
                if (stretch[g] > stretch[f] || (stretch[g] == stretch[f] && g < f))
                    highest = false;
            });
        if (highest)
            maxima.push_back(f);
    }
    std::stable_sort(maxima.begin(), maxima.end(),
                     [&](Index a, Index b) { return stretch[a] > stretch[b]; });
    return maxima;
}

} // namespace

double TrialMap::peaks_above(double bound) const {
    double sum = 0.0;
    for (const double peak : peaks)
        sum += std::max(0.0, peak - bound);
    return sum;
}

std::vector<double> measure_stretch(const flatten::FlatteningProblem& problem,
                                    const std::vector<Vec2>& uv, TrialMap& map) {
    map.area = problem.total_area;
    map.l2_squared = flatten::squared_l2_stretch(problem, uv);
    std::vector<double> stretch = flatten::face_stretches(problem, uv);
    map.linf = std::max(map.linf, *std::max_element(stretch.begin(), stretch.end()));
    map.strain = flatten::measure_strain(flatten::face_strains(problem, uv), problem.area);
    return stretch;
}

TrialMap try_chart(const Mesh& mesh, const std::vector<Index>& faces,
                   const std::vector<std::uint8_t>& seam, const TrialEffort& effort,
                   const Progress& progress, const std::vector<Vec2>& turns) {
    TrialMap map;
    for (const Face f : faces)
        map.area += mesh.face_areas[f];
    std::vector<std::uint8_t> marks = atlas::enclose(mesh, faces, seam);
    const atlas::ChartSurface surface = atlas::cut_to_disk(
        mesh, atlas::extract_surface(mesh, faces, marks), marks, progress, &map.cut_length);
    if (map.cut_length > effort.most_cut_length)
        return map;
    const flatten::FlatteningProblem problem = flatten::make_flattening_problem(mesh, surface);
    std::vector<Vec2> uv;
    auto development = flatten::unfold(problem);
    const bool developed = development.has_value();
    if (developed)
        uv = std::move(*development);
    else
        uv = flatten::attempt(
            [&] { return Trial(surface, problem, effort, progress).flatten(turns); });
    map.flat = !uv.empty();
    if (!map.flat)
        return map;
    std::vector<double> stretch = measure_stretch(problem, uv, map);
    if (effort.give_up && map.l2_squared > effort.wanted_l2 * effort.wanted_l2)
        return map; // whatever else there is to know
    const double tolerance = plane::layout_tolerance(problem.model_size);
    map.overlaps = flatten::overlaps_itself(surface, uv, tolerance);
    if (map.overlaps && effort.push_apart && !developed) // developments stay as they are
        if (auto apart = flatten::push_apart(problem, surface, uv,
                                             flatten::overlapping_pairs(surface, uv, tolerance),
                                             tolerance, progress)) {
            uv = std::move(*apart);
            map.overlaps = false;
            map.linf = 1.0;
            stretch = measure_stretch(problem, uv, map);
        }
    map.turns = flatten::face_turns(problem, uv);
    map.worst_faces = local_maxima(surface, stretch);
    for (Index& f : map.worst_faces) {
        map.peaks.push_back(stretch[f]);
        f = surface.face[f];
    }
    return map;
}

} // namespace devseg::judge
