#include "devseg/judge/trial.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/atlas/disks.h"
#include "devseg/base/errors.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/flatten/maps/lscm.h"
#include "devseg/flatten/maps/tutte.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/flatten/repair/push_apart.h"
#include "devseg/plane/overlap.h"

namespace devseg::judge {

namespace {

// Rounds stop when ten of them gain less than this share of the excess that is compared with.
constexpr double precision = 1e-3;
constexpr double coarsest = 1e-5; // relative to the energy
constexpr double finest = 1e-7;
constexpr int few_rounds = 40;
constexpr int many_rounds = 200;

// Near an isometry l2² − 1 is 1.5 to 2 times the excess of the symmetric Dirichlet energy over 1,
// depending on how much of the distortion is shear: an energy whose excess is that of the wanted
// l2² is hopeless.
std::vector<Vec2> trial_uv(const flatten::FlatteningProblem& problem, const TrialEffort& effort,
                           const Progress& progress) {
    std::vector<Vec2> uv = flatten::flatten_lscm(problem);
    if (flatten::count_flips(problem, uv) > 0)
        uv = flatten::flatten_tutte(problem);
    flatten::SymmetricDirichletOptions options;
    const double excess = effort.wanted_l2 * effort.wanted_l2 - 1.0;
    options.relative_tolerance = std::clamp(precision * excess, finest, coarsest);
    options.max_iterations = precision * excess < coarsest ? many_rounds : few_rounds;
    if (effort.give_up)
        options.give_up_energy = 1.0 + excess;
    uv = flatten::minimise_symmetric_dirichlet(problem, uv, options, progress).uv;
    flatten::scale_to_area(problem, uv);
    return uv;
}

// Faces that are stretched more than all faces around them.
std::vector<Index> local_maxima(const atlas::ChartSurface& surface,
                                const std::vector<double>& stretch) {
    std::vector<Index> maxima;
    for (const Face f : surface.all_faces()) {
        bool highest = true;
        for (HalfEdge h = 3 * f; h < 3 * f + 3 && highest; ++h)
            mesh::visit_star(surface.twin, h, [&](Index k) {
                const Index g = k / 3;
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
    std::vector<double> stretch(problem.faces.size());
    map.area = problem.total_area;
    map.l2_squared = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Eigen::Matrix2d j = flatten::jacobian(problem, uv, f);
        const double det = j.determinant();
        stretch[f] = flatten::face_stretch(problem, uv, f);
        map.l2_squared +=
            0.5 * j.squaredNorm() / (det * det) * problem.area[f] / problem.total_area;
        map.linf = std::max(map.linf, stretch[f]);
    }
    return stretch;
}

TrialMap try_chart(const Mesh& mesh, const std::vector<Index>& faces,
                   const std::vector<std::uint8_t>& seam, const TrialEffort& effort,
                   const Progress& progress) {
    TrialMap map;
    for (const Face f : faces)
        map.area += mesh.face_areas[f];
    std::vector<std::uint8_t> marks = atlas::enclose(mesh, faces, seam);
    const atlas::ChartSurface surface = atlas::cut_to_disk(
        mesh, atlas::extract_surface(mesh, faces, marks), marks, progress, &map.cut_length);
    const flatten::FlatteningProblem problem = flatten::make_flattening_problem(mesh, surface);
    std::vector<Vec2> uv;
    try {
        uv = trial_uv(problem, effort, progress);
    } catch (const NumericalFailure&) {
        return map; // not flat
    }
    map.flat = true;
    const double tolerance = plane::layout_tolerance(std::sqrt(mesh.total_area));
    auto pairs = flatten::overlapping_pairs(surface, uv, tolerance);
    map.overlaps = !pairs.empty();
    if (map.overlaps && effort.push_apart)
        if (auto apart =
                flatten::push_apart(problem, surface, uv, std::move(pairs), tolerance, progress)) {
            uv = std::move(*apart);
            map.overlaps = false;
        }
    const std::vector<double> stretch = measure_stretch(problem, uv, map);
    map.worst_faces = local_maxima(surface, stretch);
    for (Index& f : map.worst_faces) {
        map.peaks.push_back(stretch[f]);
        f = surface.face[f];
    }
    return map;
}

} // namespace devseg::judge
