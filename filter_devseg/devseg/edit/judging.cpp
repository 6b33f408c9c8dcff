#include "devseg/edit/judging.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <optional>
#include <utility>

#include "devseg/atlas/disks.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/multilevel.h"
#include "devseg/flatten/energy/vertex_relaxation.h"
#include "devseg/flatten/flatten.h"
#include "devseg/flatten/maps/unfold.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/plane/overlap.h"

namespace devseg::edit {

using judge::TrialMap;
using judge::WholeEffort;

namespace {

struct Tuning {
    // Of a chart that is judged: with so many its map, pushed apart, takes up to 0.15 s, and as
    // much for any chart. With half as many, more joins look flat that are not.
    Index most_faces = 8000;
};
constexpr Tuning tuning;

bool is_large(const std::vector<Index>& faces) {
    return faces.size() > at(tuning.most_faces);
}

bool is_within(const TrialMap& map, const WholeEffort& effort) {
    return effort.most_l2 <= 0.0 || map.l2_squared <= effort.most_l2 * effort.most_l2;
}

CoarseMap decimated(const Mesh& mesh, const std::vector<Index>& faces,
                    const std::vector<std::uint8_t>& seam, Progress& progress) {
    CoarseMap map;
    map.surface = atlas::extract_surface(mesh, faces, atlas::enclose(mesh, faces, seam));
    map.chart = atlas::mesh_of(mesh, map.surface);
    map.coarse = mesh::coarsen_in_parallel(map.chart, tuning.most_faces, progress);
    return map;
}

TrialMap measured(const flatten::FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    TrialMap map;
    judge::measure_stretch(problem, uv, map);
    return map;
}

// A map whose parts overlap, pushed apart as 'Charts: Flatten' does it; empty where that fails.
std::vector<Vec2> pushed(const flatten::FlatteningProblem& problem,
                         const atlas::ChartSurface& surface, const std::vector<Vec2>& uv,
                         const Progress& progress) {
    const double tolerance = plane::layout_tolerance(problem.model_size);
    const auto pairs = flatten::overlapping_pairs(surface, uv, tolerance);
    if (pairs.empty())
        return uv;
    auto apart = flatten::push_apart(problem, surface, uv, pairs, tolerance, progress);
    if (!apart)
        return {};
    std::vector<Vec2> relieved = *apart;
    flatten::relieve_peaks(problem, true, relieved, progress);
    return flatten::overlaps_itself(surface, relieved, tolerance) ? *apart : relieved;
}

// Of the coarse chart; fills in `coarse.uv`.
TrialMap flattened(CoarseMap& coarse, const WholeEffort& effort, Progress& progress) {
    const Mesh& mesh = coarse.coarse.mesh;
    const std::vector<Index> one(mesh.faces.size(), 0);
    const atlas::ChartMap disk =
        atlas::cut_charts_to_disks(mesh, atlas::make_chart_map(mesh, one, {}, false), progress)
            .charts;
    flatten::WholeChart asked;
    asked.push_apart = false;
    flatten::FlatChart flat =
        std::move(flatten::flatten_whole(mesh, disk, flatten::FlattenMethod::symmetric_dirichlet,
                                         asked, progress)
                      .front());
    TrialMap map;
    if (flat.uv.empty()) {
        map.l2_squared = infinite;
        return map;
    }
    const auto problem = flatten::make_flattening_problem(mesh, flat.surface);
    map = measured(problem, flat.uv);
    map.flat = !flat.torn;
    if (flat.torn && !flat.developed && effort.push_apart && is_within(map, effort)) {
        const std::vector<Vec2> apart = pushed(problem, flat.surface, flat.uv, progress);
        if (!apart.empty()) {
            map = measured(problem, apart);
            map.flat = true;
        }
    }
    if (flat.surface.vertex.size() == mesh.points.size())
        coarse.uv = std::move(flat.uv);
    return map;
}

// A map of all faces that is near to the coarse one and to the best one; nothing where it is not
// good. Charts that unfold exactly are taken as they are: their parts are not pushed apart.
std::optional<TrialMap> refined(const Mesh& mesh, CoarseMap coarse, const WholeEffort& effort,
                                const Progress& progress) {
    const auto problem = flatten::make_flattening_problem(mesh, coarse.surface);
    if (coarse.uv.empty() || flatten::largest_defect(problem) <= flatten::exact_angle ||
        flatten::unfold(problem))
        return std::nullopt;
    std::vector<Vec2> uv(coarse.chart.points.size(), Vec2::Zero());
    for (std::size_t v = 0; v < coarse.uv.size(); ++v)
        uv[at(coarse.coarse.vertex[v])] = coarse.uv[v];
    uv = flatten::refine_map(coarse.chart, std::move(coarse.coarse.surface), std::move(uv), problem,
                             progress);
    flatten::settle_peaks(problem, uv, progress);
    flatten::relieve_peaks(problem, false, uv, progress);
    flatten::scale_to_area(problem, uv);
    if (effort.push_apart)
        uv = pushed(problem, coarse.surface, uv, progress);
    if (uv.empty() || flatten::count_flips(problem, uv) > 0 ||
        flatten::overlaps_itself(coarse.surface, uv, plane::layout_tolerance(problem.model_size)))
        return std::nullopt;
    TrialMap map = measured(problem, uv);
    map.flat = true;
    if (!is_within(map, effort))
        return std::nullopt;
    return map;
}

} // namespace

QuickMaps quick_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                     const std::vector<std::uint8_t>& seam, const WholeEffort& effort,
                     Progress& progress) {
    std::vector<std::vector<Index>> small;
    std::copy_if(charts.begin(), charts.end(), std::back_inserter(small),
                 [&](const auto& faces) { return !is_large(faces); });
    auto judging = progress.part("flattening what has changed", 0.3);
    std::vector<TrialMap> of_small = judge::whole_maps(mesh, small, seam, effort, judging);
    QuickMaps quick;
    auto next = of_small.begin();
    for (std::size_t c = 0; c < charts.size(); ++c) {
        auto one = progress.part("flattening what has changed",
                                 progress.left() / static_cast<double>(charts.size() - c));
        if (!is_large(charts[c])) {
            quick.maps.push_back(std::move(*next++));
            continue;
        }
        auto decimating = one.part("decimating what has changed", 0.3);
        CoarseMap coarse = decimated(mesh, charts[c], seam, decimating);
        auto flattening = one.part("flattening what has changed", one.left());
        quick.maps.push_back(flattened(coarse, effort, flattening));
        quick.maps.back().area = atlas::area_of(mesh, coarse.surface);
        quick.coarse.push_back(std::move(coarse));
    }
    return quick;
}

void confirm_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                  const std::vector<std::uint8_t>& seam, const WholeEffort& effort,
                  QuickMaps& quick, Progress& progress) {
    std::vector<std::size_t> open;
    std::vector<std::vector<Index>> faces;
    auto next = quick.coarse.begin();
    for (std::size_t c = 0; c < charts.size(); ++c) {
        if (!is_large(charts[c]))
            continue;
        auto map =
            flatten::attempt([&] { return refined(mesh, std::move(*next), effort, progress); });
        ++next;
        if (map) {
            quick.maps[c] = std::move(*map);
        } else {
            open.push_back(c);
            faces.push_back(charts[c]);
        }
    }
    std::vector<TrialMap> whole = judge::whole_maps(mesh, faces, seam, effort, progress);
    for (std::size_t i = 0; i < open.size(); ++i)
        quick.maps[open[i]] = std::move(whole[i]);
}

} // namespace devseg::edit
