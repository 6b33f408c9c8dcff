#include "devseg/methods/dcharts/draft.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "devseg/atlas/border_path.h"
#include "devseg/atlas/fragments.h"
#include "devseg/base/parallel.h"
#include "devseg/mesh/angle_defects.h"
#include "devseg/methods/baselines/baselines.h"
#include "devseg/methods/dcharts/tuning.h"
#include "devseg/methods/growth/borders.h"

namespace devseg::dcharts {

using judge::TrialEffort;
using judge::TrialMap;

Index Draft::charts_number() const {
    return static_cast<Index>(
        std::count_if(faces.begin(), faces.end(), [](const auto& part) { return !part.empty(); }));
}

double Draft::excess() const {
    double sum = 0.0;
    for (std::size_t c = 0; c < faces.size(); ++c)
        sum += faces[c].empty() ? 0.0 : map[c].excess();
    return sum;
}

Draft make_untried_draft(const Mesh& mesh, const std::vector<Index>& chart) {
    Draft draft;
    draft.chart = chart;
    draft.seam.assign(mesh.twin.size(), 0);
    for (const Face f : mesh.all_faces()) {
        const std::size_t c = at(chart[f]);
        if (draft.faces.size() <= c)
            draft.faces.resize(c + 1);
        draft.faces[c].push_back(f);
    }
    draft.map.resize(draft.faces.size());
    return draft;
}

Draft make_draft(const Mesh& mesh, const std::vector<Index>& chart,
                 const std::vector<std::uint8_t>& seam, double wanted_l2, Progress& progress) {
    Draft draft = make_untried_draft(mesh, chart);
    if (!seam.empty())
        draft.seam = seam;
    TrialEffort effort;
    effort.wanted_l2 = wanted_l2;
    parallel_for(
        static_cast<int>(draft.faces.size()),
        [&](int c) {
            if (!draft.faces[at(c)].empty())
                draft.map[at(c)] =
                    judge::try_chart(mesh, draft.faces[at(c)], draft.seam, effort, progress);
        },
        progress);
    return draft;
}

// Joins
namespace {

using Pair = std::pair<Index, Index>;        // of charts, the lower number first
using Borders = std::map<Pair, double>;      // length of the border between two charts
using JoinedMaps = std::map<Pair, TrialMap>; // what the two would be as one chart

Borders measure_borders(const Mesh& mesh, const std::vector<Index>& chart) {
    Borders length;
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge twin = mesh.twin[h];
        if (twin > h && chart[face_of(h)] != chart[face_of(twin)])
            length[std::minmax(chart[face_of(h)], chart[face_of(twin)])] += mesh.edge_length(h);
    }
    return length;
}

std::vector<Index> united(const Draft& draft, const Pair& pair) {
    const std::vector<Index>& a = draft.faces[pair.first];
    const std::vector<Index>& b = draft.faces[pair.second];
    std::vector<Index> faces(a.size() + b.size());
    std::merge(a.begin(), a.end(), b.begin(), b.end(), faces.begin());
    return faces;
}

// Stretch up to which a joined chart may be worth having.
StretchBounds joined_bounds(const Mesh& mesh, const MergeOptions& options, const Draft& draft,
                            const Pair& pair) {
    const TrialMap& a = draft.map[pair.first];
    const TrialMap& b = draft.map[pair.second];
    StretchBounds limit = options.chart;
    limit.linf = std::max({limit.linf, a.linf, b.linf});
    if (std::min(a.area, b.area) < options.small_share * mesh.total_area) {
        limit.l2 = std::max({limit.l2, std::sqrt(a.l2_squared), std::sqrt(b.l2_squared)});
        limit.l2 = 1.0 + tuning.small_allowance * (limit.l2 - 1.0);
        limit.linf = 1.0 + tuning.small_allowance * (limit.linf - 1.0);
    }
    return limit;
}

void try_new_pairs(const Mesh& mesh, const MergeOptions& options, const Draft& draft,
                   const Borders& borders, JoinedMaps& joined, Progress& progress) {
    std::vector<Pair> open;
    for (const auto& [pair, length] : borders)
        if (joined.count(pair) == 0)
            open.push_back(pair);
    std::vector<TrialMap> maps(open.size());
    parallel_for(
        static_cast<int>(open.size()),
        [&](int i) {
            const Pair& pair = open[at(i)];
            TrialEffort effort;
            effort.wanted_l2 = joined_bounds(mesh, options, draft, pair).l2;
            effort.give_up = true;
            maps[at(i)] = judge::try_chart(mesh, united(draft, pair), draft.seam, effort, progress);
        },
        progress);
    for (std::size_t i = 0; i < open.size(); ++i)
        joined[open[i]] = maps[i];
}

// The pair whose border is bought off at the lowest price; −1 if there is none.
Pair cheapest_pair(const Mesh& mesh, const MergeOptions& options, const Draft& draft,
                   const Borders& borders, const JoinedMaps& joined) {
    const double excess = draft.excess();
    Pair best(-1, -1);
    double lowest = infinite;
    for (const auto& [pair, length] : borders) {
        const TrialMap& map = joined.at(pair);
        const TrialMap& a = draft.map[pair.first];
        const TrialMap& b = draft.map[pair.second];
        const double added = map.excess() - a.excess() - b.excess();
        const double saved = length - map.cut_length + a.cut_length + b.cut_length;
        const double least_border = options.least_neck * std::sqrt(std::min(a.area, b.area));
        if (!map.flat || !joined_bounds(mesh, options, draft, pair).hold(map) ||
            !(excess + added <= options.max_excess) || !(saved > 0.0) || saved < least_border)
            continue;
        const double price = (std::max(0.0, added) + tuning.negligible * mesh.total_area) / saved;
        if (price < lowest) {
            lowest = price;
            best = pair;
        }
    }
    return best;
}

// The same, and its joined map does not lie on itself: overlaps are worth resolving only here.
Pair choose_pair(const Mesh& mesh, const MergeOptions& options, const Draft& draft,
                 const Borders& borders, JoinedMaps& joined, const Progress& progress) {
    while (true) {
        const Pair best = cheapest_pair(mesh, options, draft, borders, joined);
        if (best.first < 0 || !joined[best].overlaps)
            return best;
        TrialEffort effort;
        effort.wanted_l2 = joined_bounds(mesh, options, draft, best).l2;
        effort.push_apart = true;
        TrialMap& map = joined[best];
        map = judge::try_chart(mesh, united(draft, best), draft.seam, effort, progress);
        map.flat = map.flat && !map.overlaps;
    }
}

void join(const Pair& pair, Draft& draft, JoinedMaps& joined) {
    const auto [a, b] = pair;
    for (const Face f : draft.faces[b])
        draft.chart[f] = a;
    draft.faces[a] = united(draft, pair);
    draft.faces[b].clear();
    draft.map[a] = joined[pair];
    ++draft.joins;
    for (auto it = joined.begin(); it != joined.end();) {
        const auto [first, second] = it->first;
        const bool concerned = first == a || second == a || first == b || second == b;
        it = concerned ? joined.erase(it) : std::next(it);
    }
}

} // namespace

void merge_charts(const Mesh& mesh, const MergeOptions& options, Draft& draft, Progress& progress) {
    JoinedMaps joined;
    while (true) {
        const Borders borders = measure_borders(mesh, draft.chart);
        auto trying = progress.part(0.0); // joins say how far it is
        try_new_pairs(mesh, options, draft, borders, joined, trying);
        const Pair best = choose_pair(mesh, options, draft, borders, joined, progress);
        if (best.first < 0)
            return;
        join(best, draft, joined);
        progress.update(static_cast<double>(draft.joins) / static_cast<double>(draft.faces.size()));
    }
}

// Splits
namespace {

Index count_labels(const std::vector<Index>& label) {
    return 1 + *std::max_element(label.begin(), label.end());
}

Mesh mesh_of_chart(const Mesh& mesh, const std::vector<Index>& faces) {
    const std::vector<std::uint8_t> no_cuts(mesh.twin.size(), 0);
    return atlas::mesh_of(
        mesh, atlas::extract_surface(mesh, faces, atlas::enclose(mesh, faces, no_cuts)));
}

// Label 0 keeps the chart's number. False where there is just one.
bool take_apart(const Mesh& mesh, const std::vector<Index>& label, double wanted_l2, Index chart,
                Draft& draft, Progress& progress) {
    const Index count = count_labels(label);
    if (count < 2)
        return false;
    const std::vector<Index> faces = std::move(draft.faces[chart]);
    const Index first_new = static_cast<Index>(draft.faces.size());
    const auto number = [&](Index l) { return l == 0 ? chart : first_new + l - 1; };
    draft.faces[chart].clear();
    draft.faces.resize(draft.faces.size() + at(count - 1));
    draft.map.resize(draft.faces.size());
    for (std::size_t i = 0; i < faces.size(); ++i) {
        const Index c = number(label[i]);
        draft.chart[faces[i]] = c;
        draft.faces[c].push_back(faces[i]);
        for (const HalfEdge h : half_edges_of(faces[i]))
            draft.seam[h] = 0;
    }
    TrialEffort effort;
    effort.wanted_l2 = wanted_l2;
    for (Index l = 0; l < count; ++l)
        draft.map[number(l)] =
            judge::try_chart(mesh, draft.faces[number(l)], draft.seam, effort, progress);
    return true;
}

} // namespace

bool split_chart(const Mesh& mesh, const DChartsOptions& options, double wanted_l2, Index chart,
                 Draft& draft, Progress& progress) {
    if (draft.faces[chart].size() < 2)
        return false;
    const Mesh part = mesh_of_chart(mesh, draft.faces[chart]);
    DChartsOptions two = options;
    two.charts_number = 2;
    const DChartsResult grown = segment_dcharts(part, two, progress);
    std::vector<Index> label = grown.chart;
    growth::ExpansionOptions expansion;
    expansion.max_fitting_error = options.max_fitting_error;
    growth::relabel_by_expansion(part, grown.proxies, expansion, label, progress);
    label = atlas::absorb_fragments(part, label, tuning.smallest_part);
    if (count_labels(label) < 2) // the shortest border is none: take the charts as they grew
        label = atlas::absorb_fragments(part, grown.chart, tuning.smallest_part);
    return take_apart(mesh, label, wanted_l2, chart, draft, progress);
}

bool halve_chart(const Mesh& mesh, double wanted_l2, Index chart, Draft& draft,
                 Progress& progress) {
    if (draft.faces[chart].size() < 2)
        return false;
    baselines::VsaOptions planes;
    planes.charts_number = 2;
    const Mesh part = mesh_of_chart(mesh, draft.faces[chart]);
    return take_apart(mesh, baselines::segment_vsa(part, planes, progress).chart, wanted_l2, chart,
                      draft, progress);
}

// Darts
namespace {

struct Dart {
    std::vector<Index> path; // half-edges of the mesh
    Index tip = -1;          // vertex of the mesh
    TrialMap map;            // of the chart with the dart
    double length = 0.0;
};

// The corner of a face around which the surface bends most: where a cone's tip would be.
Vertex sharpest_corner(const Mesh& mesh, Face face) {
    Vertex best;
    double largest = -1.0;
    for (const HalfEdge h : half_edges_of(face)) {
        double angles = 0.0;
        const bool inner = mesh::visit_star(mesh, h, [&](HalfEdge k) {
            angles += mesh::corner_angle(mesh.points[mesh.origin(k)], mesh.points[mesh.target(k)],
                                         mesh.points[mesh.origin(Mesh::previous(k))]);
        });
        const double defect = inner ? std::abs(2.0 * pi - angles) : 0.0;
        if (defect > largest) {
            largest = defect;
            best = mesh.origin(h);
        }
    }
    return best;
}

// What the dart gains for each unit of length; 0 where it is not worth cutting. `map` is that of
// the chart without it.
double worth(const Mesh& mesh, const DartOptions& options, const TrialMap& map, const Dart& dart) {
    if (!dart.map.flat || (dart.map.overlaps && !map.overlaps))
        return 0.0;
    const double root = std::sqrt(mesh.total_area);
    const double gain = (map.excess() - dart.map.excess()) / mesh.total_area / (dart.length / root);
    const double above = map.linf - options.chart.linf;
    // Of several spots above the bound, a dart takes one.
    const double lower =
        map.peaks_above(options.chart.linf) - dart.map.peaks_above(options.chart.linf);
    if (above > 0.0 && lower > tuning.worst_spot_gain * above)
        return std::max(gain, 0.0) + options.worth * lower / above;
    return gain >= options.worth ? gain : 0.0;
}

// Without a path where no dart is worth its length.
Dart best_dart(const Mesh& mesh, const DartOptions& options, const std::vector<Index>& faces,
               const std::vector<std::uint8_t>& seam, const TrialMap& map,
               const Progress& progress) {
    Dart best;
    double highest = 0.0;
    for (std::size_t i = 0; i < std::min(tuning.tried_spots, map.worst_faces.size()); ++i) {
        Dart dart;
        dart.tip = sharpest_corner(mesh, map.worst_faces[i]);
        dart.path = atlas::path_to_border(mesh, faces, seam, dart.tip);
        if (dart.path.empty())
            continue;
        for (const HalfEdge h : dart.path)
            dart.length += mesh.edge_length(h);
        std::vector<std::uint8_t> with_dart = seam;
        atlas::mark_cuts(mesh, dart.path, with_dart);
        TrialEffort effort;
        effort.wanted_l2 = options.chart.l2;
        dart.map = judge::try_chart(mesh, faces, with_dart, effort, progress);
        const double value = worth(mesh, options, map, dart);
        if (value > highest) {
            highest = value;
            best = std::move(dart);
        }
    }
    return best;
}

// Of one chart; the cuts of other charts do not matter.
std::vector<Dart> find_darts(const Mesh& mesh, const DartOptions& options, const Draft& draft,
                             std::size_t chart, const Progress& progress) {
    std::vector<std::uint8_t> seam = draft.seam;
    TrialMap map = draft.map[chart];
    std::vector<Dart> darts;
    while (static_cast<int>(darts.size()) < options.max_per_chart && map.flat &&
           !options.chart.hold(map)) {
        progress.check();
        Dart best = best_dart(mesh, options, draft.faces[chart], seam, map, progress);
        if (best.path.empty())
            break;
        atlas::mark_cuts(mesh, best.path, seam);
        map = best.map;
        darts.push_back(std::move(best));
    }
    return darts;
}

} // namespace

Index cut_darts(const Mesh& mesh, const DartOptions& options, Draft& draft, Progress& progress) {
    std::vector<std::vector<Dart>> darts(draft.faces.size());
    parallel_for(
        static_cast<int>(draft.faces.size()),
        [&](int c) {
            if (!draft.faces[at(c)].empty() && !options.chart.hold(draft.map[at(c)]))
                darts[at(c)] = find_darts(mesh, options, draft, at(c), progress);
        },
        progress);
    Index count = 0;
    for (std::size_t c = 0; c < darts.size(); ++c)
        for (const Dart& dart : darts[c]) {
            atlas::mark_cuts(mesh, dart.path, draft.seam);
            draft.tips.push_back(dart.tip);
            draft.map[c] = dart.map;
            ++count;
        }
    return count;
}

Index cut_darts_to(const Mesh& mesh, const std::vector<Index>& chart,
                   const std::vector<Index>& tips, std::vector<std::uint8_t>& seam) {
    const std::vector<Index> leaving = mesh::leaving_half_edges(mesh);
    Index cuts = 0;
    for (const Vertex tip : tips) {
        const Index label = chart[face_of(leaving[tip])];
        std::vector<Index> faces;
        for (const Face f : mesh.all_faces())
            if (chart[f] == label)
                faces.push_back(f);
        const std::vector<Index> path = atlas::path_to_border(mesh, faces, seam, tip);
        atlas::mark_cuts(mesh, path, seam);
        cuts += path.empty() ? 0 : 1;
    }
    return cuts;
}

} // namespace devseg::dcharts
