#include "devseg/judge/final_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/atlas/disks.h"
#include "devseg/atlas/holes.h"
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

// Of the charts together; the stretch of one that was cut apart is the mean of its parts'.
class Measures {
public:
    Measures(const Extract& part, const std::vector<std::vector<Index>>& charts)
        : part_(part), maps_(charts.size()), place_(part.chart.size()), excess_(charts.size(), 0.0),
          parts_(charts.size(), 0) {
        std::vector<Index> seen(charts.size(), 0);
        for (std::size_t f = 0; f < place_.size(); ++f)
            place_[f] = seen[at(part.chart[f])]++;
        for (std::size_t c = 0; c < maps_.size(); ++c) {
            maps_[c].turns.resize(charts[c].size());
            maps_[c].part.resize(charts[c].size());
        }
    }

    void add(const flatten::FlatChart& flat) {
        const Index c = part_.chart[flat.surface.face.front()];
        TrialMap& whole = maps_[at(c)];
        const auto problem = flatten::make_flattening_problem(part_.mesh, flat.surface);
        TrialMap map;
        measure_stretch(problem, flat.uv, map);
        excess_[at(c)] += map.excess();
        whole.area += map.area;
        whole.linf = std::max(whole.linf, map.linf);
        whole.strain.take_worse(map.strain);
        const std::vector<Vec2> turns = flatten::face_turns(problem, flat.uv);
        for (std::size_t f = 0; f < turns.size(); ++f) {
            const Index place = place_[at(flat.surface.face[f])];
            whole.turns[at(place)] = turns[f];
            whole.part[at(place)] = parts_[at(c)];
        }
        ++parts_[at(c)];
    }

    std::vector<TrialMap> take() {
        for (std::size_t c = 0; c < maps_.size(); ++c) {
            maps_[c].flat = parts_[c] == 1;
            if (maps_[c].flat)
                maps_[c].part.clear();
            if (maps_[c].area > 0.0)
                maps_[c].l2_squared = 1.0 + excess_[c] / maps_[c].area;
        }
        return std::move(maps_);
    }

private:
    const Extract& part_;
    std::vector<TrialMap> maps_;
    std::vector<Index> place_; // of each face among those of its chart
    std::vector<double> excess_;
    std::vector<int> parts_;
};

// The charts cut open to disks.
atlas::ChartMap disks_of(const Extract& part, Progress& progress) {
    auto cutting = progress.part("measuring final maps", 0.1);
    return atlas::cut_charts_to_disks(
               part.mesh, atlas::make_chart_map(part.mesh, part.chart, {}, false), cutting)
        .charts;
}

} // namespace

std::vector<TrialMap> final_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                                 const std::vector<std::uint8_t>& seam, Progress& progress,
                                 MapFor purpose) {
    if (charts.empty())
        return {};
    const Extract part = extract(mesh, charts, seam);
    const atlas::ChartMap disks = disks_of(part, progress);
    auto flattening = progress.part("measuring final maps", 0.9);
    const flatten::FlattenResult result = flatten::flatten_charts(
        part.mesh, disks,
        purpose == MapFor::cloth ? flatten::FlattenMethod::lpfb
                                 : flatten::FlattenMethod::symmetric_dirichlet,
        flattening);
    Measures measures(part, charts);
    for (const flatten::FlatChart& flat : result.flat)
        measures.add(flat);
    return measures.take();
}

std::vector<TrialMap> whole_maps(const Mesh& mesh, const std::vector<std::vector<Index>>& charts,
                                 const std::vector<std::uint8_t>& seam, const WholeEffort& effort,
                                 Progress& progress) {
    if (charts.empty())
        return {};
    const Extract part = extract(mesh, charts, seam);
    const atlas::ChartMap disks = disks_of(part, progress);
    auto flattening = progress.part("measuring final maps", 0.9);
    const double most = effort.most_l2 * effort.most_l2;
    flatten::WholeChart asked;
    asked.is_good = [&](const flatten::FlatteningProblem& problem, const std::vector<Vec2>& uv) {
        TrialMap map;
        measure_stretch(problem, uv, map);
        return most <= 0.0 || map.l2_squared <= most;
    };
    asked.push_apart = effort.push_apart;
    const std::vector<flatten::FlatChart> whole = flatten::flatten_whole(
        part.mesh, disks, flatten::FlattenMethod::symmetric_dirichlet, asked, flattening);
    Measures measures(part, charts);
    for (const flatten::FlatChart& flat : whole)
        if (!flat.uv.empty())
            measures.add(flat);
    std::vector<TrialMap> maps = measures.take();
    for (const flatten::FlatChart& flat : whole)
        if (flat.torn) {
            TrialMap& map = maps[at(part.chart[flat.surface.face.front()])];
            map.flat = false;
            map.l2_squared = flat.uv.empty() ? infinite : map.l2_squared;
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
    if (!atlas::is_sound(mesh, surface)) // seams take it apart
        return false;
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
