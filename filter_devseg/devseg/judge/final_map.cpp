#include "devseg/judge/final_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/atlas/disks.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/flatten/flatten.h"
#include "devseg/flatten/maps/arap.h"
#include "devseg/flatten/maps/lscm.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/plane/overlap.h"

namespace devseg::judge {

namespace {

// The charts as a mesh of their own.
struct Extract {
    Mesh mesh;
    std::vector<Index> chart; // #f of `mesh`
};

Extract extract(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                const std::vector<std::uint8_t>& seam) {
    std::vector<Index> chart(mesh.faces.size(), -1);
    std::vector<Index> faces;
    std::vector<std::uint8_t> marks = seam;
    for (std::size_t c = 0; c < charts.size(); ++c)
        for (const Face f : charts[c]) {
            chart[f] = static_cast<Index>(c);
            faces.push_back(f);
        }
    std::sort(faces.begin(), faces.end());
    for (const Face f : faces)
        for (const HalfEdge h : half_edges_of(f))
            if (mesh.twin[h] >= 0 && chart[mesh.across(h)] != chart[f])
                marks[h] = marks[mesh.twin[h]] = 1;
    const atlas::ChartSurface surface = atlas::extract_surface(mesh, faces, marks);
    Extract result{atlas::mesh_of(mesh, surface), {}};
    for (const Face f : faces)
        result.chart.push_back(chart[f]);
    return result;
}

} // namespace

std::vector<TrialMap> final_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                                 const std::vector<std::uint8_t>& seam, Progress& progress) {
    std::vector<TrialMap> maps(charts.size());
    if (charts.empty())
        return maps;
    const Extract part = extract(mesh, charts, seam);
    auto cutting = progress.part("measuring final maps", 0.1);
    const atlas::ChartMap disks =
        atlas::cut_charts_to_disks(part.mesh,
                                   atlas::make_chart_map(part.mesh, part.chart, {}, false), cutting)
            .charts;
    auto flattening = progress.part("measuring final maps", 0.9);
    const flatten::FlattenResult result = flatten::flatten_charts(
        part.mesh, disks, flatten::FlattenMethod::symmetric_dirichlet, flattening);
    std::vector<Index> place(part.chart.size()); // of each face among those of its chart
    std::vector<Index> seen(charts.size(), 0);
    for (std::size_t f = 0; f < place.size(); ++f)
        place[f] = seen[at(part.chart[f])]++;
    for (std::size_t c = 0; c < maps.size(); ++c)
        maps[c].turns.resize(charts[c].size());
    for (std::size_t c = 0; c < maps.size(); ++c)
        maps[c].part.resize(charts[c].size());
    std::vector<double> excess(charts.size(), 0.0);
    std::vector<int> parts(charts.size(), 0);
    for (const flatten::FlatChart& flat : result.flat) {
        const Index c = part.chart[flat.surface.face.front()];
        const auto problem = flatten::make_flattening_problem(part.mesh, flat.surface);
        TrialMap map;
        measure_stretch(problem, flat.uv, map);
        excess[at(c)] += map.excess();
        maps[at(c)].area += map.area;
        maps[at(c)].linf = std::max(maps[at(c)].linf, map.linf);
        const std::vector<Vec2> turns = flatten::face_turns(problem, flat.uv);
        for (std::size_t f = 0; f < turns.size(); ++f) {
            const Index at_place = place[at(flat.surface.face[f])];
            maps[at(c)].turns[at(at_place)] = turns[f];
            maps[at(c)].part[at(at_place)] = parts[at(c)];
        }
        ++parts[at(c)];
    }
    for (std::size_t c = 0; c < maps.size(); ++c) {
        maps[c].flat = parts[c] == 1;
        if (maps[c].flat)
            maps[c].part.clear();
        if (maps[c].area > 0.0)
            maps[c].l2_squared = 1.0 + excess[c] / maps[c].area;
    }
    return maps;
}

// The final map has the least symmetric Dirichlet energy, and l2² − 1 is at most twice the excess
// of that energy over 1: any map without flips gives a bound.
bool is_surely_within(const Mesh& mesh, const std::vector<Index>& faces,
                      const std::vector<std::uint8_t>& seam, double l2, const Progress& progress) {
    std::vector<std::uint8_t> marks = atlas::enclose(mesh, faces, seam);
    const atlas::ChartSurface surface =
        atlas::cut_to_disk(mesh, atlas::extract_surface(mesh, faces, marks), marks, progress);
    const auto problem = flatten::make_flattening_problem(mesh, surface);
    const auto uv = flatten::attempt([&] {
        std::vector<Vec2> map = flatten::flatten_lscm(problem);
        flatten::scale_to_area(problem, map);
        return map;
    });
    if (uv.empty() || flatten::count_flips(problem, uv) > 0 ||
        flatten::overlaps_itself(surface, uv, plane::layout_tolerance(problem.model_size)))
        return false;
    return 2.0 * (flatten::symmetric_dirichlet_energy(problem, uv) - 1.0) <= l2 * l2 - 1.0;
}

} // namespace devseg::judge
