#include "devseg/edit/judging.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "devseg/flatten/energy/map_tools.h"

namespace devseg::edit {

using judge::TrialMap;
using judge::WholeEffort;

namespace {

struct Tuning {
    // Of a chart whose map is measured and refuses nothing: its L2 stretch is good to 1e-3.
    Index most_measured_faces = 4000;
};
constexpr Tuning tuning;

bool is_large(const std::vector<Index>& faces) {
    return faces.size() > at(flatten::coarse_map_faces);
}

bool is_within(const TrialMap& map, const WholeEffort& effort) {
    return effort.most_l2 <= 0.0 || map.l2_squared <= effort.most_l2 * effort.most_l2;
}

TrialMap measured(const flatten::FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    TrialMap map;
    judge::measure_stretch(problem, uv, map);
    return map;
}

CoarseChart decimated(const Mesh& mesh, const std::vector<Index>& faces,
                      const std::vector<std::uint8_t>& seam, const WholeEffort& effort,
                      const Progress& progress) {
    CoarseChart chart;
    chart.surface = atlas::extract_surface(mesh, faces, atlas::enclose(mesh, faces, seam));
    const auto may_push = [&](const flatten::FlatteningProblem& problem,
                              const std::vector<Vec2>& uv) {
        return effort.push_apart && is_within(measured(problem, uv), effort);
    };
    chart.map = flatten::map_coarsely(mesh, chart.surface,
                                      effort.push_apart ? flatten::coarse_map_faces
                                                        : tuning.most_measured_faces,
                                      may_push, progress);
    return chart;
}

// Of the coarse chart; nothing where it has no map.
std::optional<TrialMap> coarse_map(const Mesh& mesh, const CoarseChart& chart) {
    const flatten::FlatChart& flat = chart.map.flat;
    if (flat.uv.empty())
        return std::nullopt;
    TrialMap map =
        measured(flatten::make_flattening_problem(chart.map.coarse.mesh, flat.surface), flat.uv);
    map.area = atlas::area_of(mesh, chart.surface);
    map.flat = !flat.torn;
    return map;
}

// Of all faces; nothing where it is not good.
std::optional<TrialMap> refined_map(const Mesh& mesh, CoarseChart chart, const WholeEffort& effort,
                                    const Progress& progress) {
    const auto problem = flatten::make_flattening_problem(mesh, chart.surface);
    const auto uv =
        flatten::refine_coarse_map(mesh, chart.surface, problem, std::move(chart.map), progress);
    if (!uv)
        return std::nullopt;
    TrialMap map = measured(problem, *uv);
    map.flat = true;
    return is_within(map, effort) ? std::optional(std::move(map)) : std::nullopt;
}

} // namespace

QuickMaps quick_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                     const std::vector<std::uint8_t>& seam, const WholeEffort& effort,
                     Progress& progress) {
    QuickMaps quick;
    quick.maps.resize(charts.size());
    quick.coarse.resize(charts.size());
    std::vector<std::size_t> whole;
    std::vector<std::vector<Index>> faces;
    for (std::size_t c = 0; c < charts.size(); ++c) {
        if (is_large(charts[c])) {
            CoarseChart chart = decimated(mesh, charts[c], seam, effort, progress);
            if (auto map = coarse_map(mesh, chart)) {
                quick.maps[c] = std::move(*map);
                quick.coarse[c] = std::move(chart);
                continue;
            }
        }
        whole.push_back(c);
        faces.push_back(charts[c]);
    }
    std::vector<TrialMap> maps = judge::whole_maps(mesh, faces, seam, effort, progress);
    for (std::size_t i = 0; i < whole.size(); ++i)
        quick.maps[whole[i]] = std::move(maps[i]);
    return quick;
}

void confirm_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                  const std::vector<std::uint8_t>& seam, const WholeEffort& effort,
                  QuickMaps& quick, Progress& progress) {
    std::vector<std::size_t> whole;
    std::vector<std::vector<Index>> faces;
    for (std::size_t c = 0; c < charts.size(); ++c) {
        if (!quick.coarse[c])
            continue;
        auto map = flatten::attempt(
            [&] { return refined_map(mesh, std::move(*quick.coarse[c]), effort, progress); });
        if (map) {
            quick.maps[c] = std::move(*map);
        } else {
            whole.push_back(c);
            faces.push_back(charts[c]);
        }
    }
    std::vector<TrialMap> maps = judge::whole_maps(mesh, faces, seam, effort, progress);
    for (std::size_t i = 0; i < whole.size(); ++i)
        quick.maps[whole[i]] = std::move(maps[i]);
}

} // namespace devseg::edit
