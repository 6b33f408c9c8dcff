#include "devseg/edit/edits.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "devseg/atlas/border_path.h"
#include "devseg/atlas/disks.h"
#include "devseg/atlas/fragments.h"
#include "devseg/base/errors.h"
#include "devseg/edit/given_charts.h"
#include "devseg/edit/judging.h"
#include "devseg/judge/final_map.h"
#include "devseg/mesh/angle_defects.h"
#include "devseg/mesh/coarsen.h"
#include "devseg/methods/dcharts/draft.h"
#include "devseg/methods/dcharts/full_charts.h"

namespace devseg::edit {

using atlas::ChartMap;
using judge::TrialMap;
using judge::WholeEffort;

namespace {

struct Tuning {
    double least_part = 0.002; // of the surface: smaller parts are slivers nobody wants to cut out
    double least_gain = 1e-6;  // of a chart's area: less is no gain of a dart, but rounding
};
constexpr Tuning tuning;

std::string text_of(double number) {
    std::ostringstream text;
    text.precision(5);
    text << number;
    return text.str();
}

[[noreturn]] void refuse(const std::string& reason) {
    throw InvalidParameter("force: expected a change that charts bear, found that " + reason);
}

std::vector<std::vector<Index>> faces_of(const ChartMap& charts, const std::vector<Index>& which) {
    const Buckets<Index> groups = atlas::group_faces(charts);
    std::vector<std::vector<Index>> faces;
    for (const Index c : which)
        faces.emplace_back(groups[c].begin(), groups[c].end());
    return faces;
}

double worst_l2(const std::vector<TrialMap>& maps) {
    double worst = 1.0;
    for (const TrialMap& map : maps)
        worst = std::max(worst, std::sqrt(map.l2_squared));
    return worst;
}

// What `flatten` returns; a chart that has no map refuses the change.
template <class Flatten>
auto or_refuse(Flatten flatten) {
    try {
        return flatten();
    } catch (const NumericalFailure& error) {
        refuse(std::string("the chart cannot be flattened: ") + error.what());
    }
}

// Of charts that may be cut apart; with an effort, of charts that are to stay in one piece.
QuickMaps maps_of(const Mesh& mesh, const ChartMap& charts, const std::vector<Index>& which,
                  const WholeEffort* effort, Progress& progress) {
    return or_refuse([&] {
        const std::vector<std::vector<Index>> faces = faces_of(charts, which);
        return effort != nullptr
                   ? quick_maps(mesh, faces, charts.seam, *effort, progress)
                   : QuickMaps{judge::final_maps(mesh, faces, charts.seam, progress), {}};
    });
}

void measure(const std::vector<TrialMap>& maps, Edit& edit) {
    edit.l2_stretch = worst_l2(maps);
    edit.linf_stretch = 1.0;
    for (const TrialMap& map : maps)
        edit.linf_stretch = std::max(edit.linf_stretch, map.linf);
}

// Cuts the charts open where they are no disks, flattens and measures them.
QuickMaps finish(const Mesh& mesh, const std::vector<Index>& which, const WholeEffort* effort,
                 Edit& edit, Progress& progress) {
    for (const std::vector<Index>& faces : faces_of(edit.charts, which)) {
        atlas::ChartSurface surface = atlas::extract_surface(mesh, faces, edit.charts.seam);
        if (!surface.is_disk())
            atlas::cut_to_disk(mesh, std::move(surface), edit.charts.seam, progress,
                               &edit.cut_length);
    }
    auto judging = progress.part("flattening what has changed", 0.6 * progress.left());
    QuickMaps quick = maps_of(mesh, edit.charts, which, effort, judging);
    edit.changed = static_cast<Index>(which.size());
    measure(quick.maps, edit);
    return quick;
}

// The same where nothing is refused for charts that lie on themselves: nothing needs to be pushed.
std::vector<TrialMap> finish_unpushed(const Mesh& mesh, const std::vector<Index>& which, Edit& edit,
                                      Progress& progress) {
    const WholeEffort effort{0.0, false};
    std::vector<TrialMap> maps = finish(mesh, which, &effort, edit, progress).maps;
    if (!std::isfinite(edit.l2_stretch)) // some chart has no map in one piece
        maps = finish(mesh, which, nullptr, edit, progress).maps;
    return maps;
}

void check_joined(const std::vector<TrialMap>& maps, const EditBounds& bounds) {
    for (const TrialMap& map : maps) {
        const double l2 = std::sqrt(map.l2_squared);
        if (!std::isfinite(l2))
            refuse("the joined chart has no map in one piece; it would be cut apart");
        if (!map.flat)
            refuse("parts of the joined chart would lie on each other, at an L2 stretch of " +
                   text_of(l2) + "; it would be cut apart there");
        if (bounds.max_chart_l2_stretch > 0.0 && l2 > bounds.max_chart_l2_stretch)
            refuse("the joined chart would have an L2 stretch of " + text_of(l2) + ", above " +
                   text_of(bounds.max_chart_l2_stretch) +
                   "; raise max_chart_l2_stretch, or switch force on");
    }
}

void check_bound(const EditBounds& bounds) {
    check_ranges(bounds);
    if (bounds.max_chart_l2_stretch > 0.0 && bounds.max_chart_l2_stretch <= 1.0)
        refuse_option("max_chart_l2_stretch", "0 for no bound, or a number above 1",
                      bounds.max_chart_l2_stretch);
}

// Labels that hold for one chart, as seams inside it.
void mark_labels(const Mesh& part, const atlas::ChartSurface& surface, const ChartMap& labels,
                 const Mesh& mesh, std::vector<std::uint8_t>& seam) {
    for (const HalfEdge h : part.all_half_edges())
        if (labels.seam[h] != 0) {
            const HalfEdge own = surface.mesh_half_edge(h);
            seam[own] = seam[mesh.twin[own]] = 1;
        }
}

// Along the cuts; one chart only where they do not divide it.
ChartMap divide_along(const Mesh& part, std::vector<std::uint8_t> cuts, Progress& progress) {
    const std::vector<Index> one(part.faces.size(), 0);
    return atlas::make_chart_map(part, one, complete_cuts(part, std::move(cuts), progress).seam,
                                 true);
}

// D-Charts splits what is above its bound, and halves what its cones do not divide. Decided on a
// coarse surface where the chart is large.
ChartMap divide_best(const Mesh& part, double wanted_l2, Progress& progress) {
    const auto decimation = dcharts::decimate(part, false, 1, progress);
    const Mesh& coarse = decimation ? decimation->mesh : part;
    const std::vector<Index> one(coarse.faces.size(), 0);
    const auto labels = [&](auto take_apart) {
        dcharts::Draft draft = dcharts::make_untried_draft(coarse, one);
        take_apart(draft);
        if (decimation)
            draft.chart = atlas::absorb_fragments(
                part, mesh::refine_labels(part, *decimation, draft.chart, progress),
                tuning.least_part);
        return atlas::make_chart_map(part, draft.chart, {}, false);
    };
    ChartMap grown = labels([&](dcharts::Draft& draft) {
        dcharts::split_chart(coarse, {}, wanted_l2, 0, draft, progress);
    });
    if (grown.count == 2)
        return grown;
    ChartMap halves = labels([&](dcharts::Draft& draft) {
        dcharts::halve_chart(coarse, wanted_l2, 0, draft, progress);
    });
    return grown.count < 2 || (halves.count > 1 && halves.count < grown.count) ? halves : grown;
}

} // namespace

Edit remove_seams(const Mesh& mesh, const ChartMap& charts, const std::vector<std::uint8_t>& marks,
                  const EditBounds& bounds, Progress& progress) {
    check_bound(bounds);
    std::vector<std::uint8_t> seam = charts.seam;
    for (std::size_t h = 0; h < seam.size(); ++h)
        seam[h] = marks[h] != 0 ? 0 : seam[h];
    Edit edit;
    edit.charts = atlas::make_chart_map(mesh, std::vector<Index>(mesh.faces.size(), 0), seam, true);
    std::vector<Index> changed;
    for (const HalfEdge h : mesh.all_half_edges())
        if (marks[h] != 0)
            changed.push_back(edit.charts.chart[face_of(h)]);
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    if (bounds.force) {
        finish_unpushed(mesh, changed, edit, progress);
        return edit;
    }
    const WholeEffort effort{bounds.max_chart_l2_stretch};
    QuickMaps quick = finish(mesh, changed, &effort, edit, progress);
    check_joined(quick.maps, bounds);
    auto confirming = progress.part("flattening what has changed", progress.left());
    or_refuse([&] {
        confirm_maps(mesh, faces_of(edit.charts, changed), edit.charts.seam, effort, quick,
                     confirming);
    });
    check_joined(quick.maps, bounds);
    measure(quick.maps, edit);
    return edit;
}

Edit join_charts(const Mesh& mesh, const ChartMap& charts, const std::vector<Index>& which,
                 const EditBounds& bounds, Progress& progress) {
    if (which.size() < 2)
        throw InvalidParameter("expected a selection that touches two charts or more, found " +
                               std::to_string(which.size()) + "; select faces in each of them");
    std::vector<std::uint8_t> chosen(at(charts.count), 0);
    for (const Index c : which)
        chosen[at(c)] = 1;
    std::vector<std::uint8_t> marks(mesh.twin.size(), 0);
    const mesh::FaceComponents joined = mesh::face_components(mesh, [&](HalfEdge h) {
        const Index a = charts.chart[face_of(h)];
        const Index b = charts.chart[mesh.across(h)];
        return a == b || (chosen[at(a)] != 0 && chosen[at(b)] != 0);
    });
    Index first = -1;
    for (const Face f : mesh.all_faces())
        if (chosen[at(charts.chart[f])] != 0) {
            if (first >= 0 && joined.label[f] != first)
                throw InvalidParameter(
                    "expected charts that hang together by common borders, found "
                    "some that do not; select those between them as well");
            first = joined.label[f];
        }
    for (const HalfEdge h : mesh.all_half_edges())
        if (const Face g = mesh.across(h); g >= 0) {
            const Index a = charts.chart[face_of(h)];
            const Index b = charts.chart[g];
            marks[h] = a != b && chosen[at(a)] != 0 && chosen[at(b)] != 0 ? 1 : 0;
        }
    return remove_seams(mesh, charts, marks, bounds, progress);
}

Edit split_charts(const Mesh& mesh, const ChartMap& charts, const std::vector<Index>& which,
                  const std::vector<std::uint8_t>& cuts, const EditBounds& bounds,
                  Progress& progress) {
    check_bound(bounds);
    const double wanted = bounds.max_chart_l2_stretch > 0.0 ? bounds.max_chart_l2_stretch : 1.0;
    Edit edit;
    std::vector<std::uint8_t> seam = charts.seam;
    auto splitting = progress.part("splitting charts", 0.4);
    const std::vector<std::vector<Index>> faces = faces_of(charts, which);
    for (const std::vector<Index>& of_chart : faces) {
        const atlas::ChartSurface surface = atlas::extract_surface(mesh, of_chart, charts.seam);
        const Mesh part = atlas::mesh_of(mesh, surface);
        std::vector<std::uint8_t> own(part.twin.size(), 0);
        for (const HalfEdge h : part.all_half_edges())
            own[h] = part.twin[h] >= 0 && !cuts.empty() ? cuts[surface.mesh_half_edge(h)] : 0;
        ChartMap parts = divide_along(part, std::move(own), splitting);
        if (parts.count < 2)
            parts = divide_best(part, wanted, splitting);
        if (parts.count < 2)
            refuse("a chart cannot be split: it has " + std::to_string(of_chart.size()) +
                   (of_chart.size() == 1 ? " face" : " faces"));
        mark_labels(part, surface, parts, mesh, seam);
    }
    edit.charts = atlas::make_chart_map(mesh, charts.chart, seam, true);
    std::vector<Index> changed;
    for (const std::vector<Index>& of_chart : faces)
        for (const Index f : of_chart)
            changed.push_back(edit.charts.chart[at(f)]);
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    for (const TrialMap& map : finish_unpushed(mesh, changed, edit, progress))
        if (!bounds.force && map.area < tuning.least_part * mesh.total_area)
            refuse("a part would be a sliver, of " + text_of(100.0 * map.area / mesh.total_area) +
                   " % of the surface; select more faces, or switch force on");
    return edit;
}

Edit add_darts(const Mesh& mesh, const ChartMap& charts, const std::vector<Index>& vertices,
               const EditBounds& bounds, Progress& progress) {
    check_bound(bounds);
    const std::vector<Index> leaving = mesh::leaving_half_edges(mesh);
    const Buckets<Index> groups = atlas::group_faces(charts);
    Edit edit;
    edit.charts = charts;
    std::vector<Index> changed;
    for (const Vertex v : vertices) {
        const Index c = charts.chart[face_of(leaving[v])];
        const std::vector<Index> path =
            atlas::path_to_border(mesh, {groups[c].begin(), groups[c].end()}, edit.charts.seam, v);
        if (path.empty())
            throw InvalidParameter(
                "expected vertices inside of charts, where darts are to end, found "
                "one on a seam or on the border");
        atlas::mark_cuts(mesh, path, edit.charts.seam);
        changed.push_back(c);
        for (const HalfEdge h : path)
            edit.cut_length += mesh.edge_length(h);
    }
    std::sort(changed.begin(), changed.end());
    changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
    auto before = progress.part("flattening the charts", 0.5);
    const std::vector<TrialMap> old = maps_of(mesh, charts, changed, nullptr, before).maps;
    edit.l2_before = worst_l2(old);
    const std::vector<TrialMap> maps = finish(mesh, changed, nullptr, edit, progress).maps;
    for (std::size_t i = 0; i < maps.size(); ++i)
        if (!bounds.force &&
            !(maps[i].excess() < old[i].excess() - tuning.least_gain * maps[i].area))
            refuse("a dart gains nothing: the L2 stretch of its chart is " +
                   text_of(std::sqrt(old[i].l2_squared)) + " without it and " +
                   text_of(std::sqrt(maps[i].l2_squared)) + " with it; switch force on");
    return edit;
}

} // namespace devseg::edit
