#include "devseg/methods/dcharts/draft.h"

#include <algorithm>
#include <cmath>
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

Mesh mesh_of_chart(const Mesh& mesh, const std::vector<Index>& faces) {
    const std::vector<std::uint8_t> no_cuts(mesh.twin.size(), 0);
    return atlas::mesh_of(
        mesh, atlas::extract_surface(mesh, faces, atlas::enclose(mesh, faces, no_cuts)));
}

// Splits
namespace {

Index count_labels(const std::vector<Index>& label) {
    return 1 + *std::max_element(label.begin(), label.end());
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
        dart.map = judge::try_chart(mesh, faces, with_dart, effort, progress, map.turns);
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
