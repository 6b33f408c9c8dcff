#include "devseg/flatten/flatten.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "devseg/atlas/disks.h"
#include "devseg/base/parallel.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/maps/unfold.h"
#include "devseg/flatten/one_chart.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/mesh/angle_defects.h"
#include "devseg/plane/overlap.h"

namespace devseg::flatten {

namespace {

struct Tuning {
    double sliver_share = 0.01; // of the mesh's area: smaller parts are slivers
    // What a joined map may lose over the worse one of its parts: excess of its mean energy, as a
    // share and as such, and the stretch of its worst face, which may in any case be as high as
    // that of the parts. So charts keep bounds of their stretch but for 5 %.
    double excess_factor = 1.05;
    double allowed_excess = 1e-4;
    double allowed_stretch = 1.5;
    double speck_share = 5e-4; // of the mesh's area: smaller parts hang on any edge
};
constexpr Tuning tuning;

using Cuts = std::vector<std::vector<HalfEdge>>; // of the mesh, by chart

std::vector<FlatChart> without_maps(const Mesh& mesh, const atlas::ChartMap& charts) {
    std::vector<FlatChart> flat;
    for (atlas::ChartSurface& surface : atlas::extract_charts(mesh, charts))
        flat.emplace_back().surface = std::move(surface);
    return flat;
}

std::vector<Index> numbers_of(const std::vector<FlatChart>& flat) {
    std::vector<Index> numbers(flat.size());
    std::iota(numbers.begin(), numbers.end(), 0);
    return numbers;
}

// Flattens the charts with the given numbers; returns where to cut them.
Cuts flatten_some(const Mesh& mesh, FlattenMethod method, std::vector<Index> which,
                  std::vector<FlatChart>& flat, Progress& progress,
                  const WholeChart* whole = nullptr) {
    // The largest first, so that no core is left with a large chart at the end.
    std::stable_sort(which.begin(), which.end(), [&](Index a, Index b) {
        return flat[a].surface.face.size() > flat[b].surface.face.size();
    });
    Cuts cuts(flat.size());
    parallel_for(
        static_cast<int>(which.size()),
        [&](int i) {
            progress.check();
            const Index c = which[i];
            cuts[c] = flatten_one(mesh, method, flat[c], progress, whole);
        },
        progress);
    return cuts;
}

// Takes over other charts, numbered in the order of their first faces, each with the map that the
// chart of its first face had, unless that one was cut. Returns the numbers of those without a map.
std::vector<Index> take_over(const Mesh& mesh, atlas::ChartMap charts, const Cuts& cuts,
                             FlattenResult& result) {
    const Buckets<Index> group = atlas::group_faces(charts);
    std::vector<FlatChart> flat(at(charts.count));
    std::vector<Index> open;
    for (Index c = 0; c < charts.count; ++c) {
        const Index old = result.charts.chart[*group[c].begin()];
        if (cuts[old].empty()) {
            flat[c] = std::move(result.flat[old]);
            continue;
        }
        flat[c].surface =
            atlas::extract_surface(mesh, {group[c].begin(), group[c].end()}, charts.seam);
        flat[c].cut_off = true;
        open.push_back(c);
    }
    result.charts = std::move(charts);
    result.flat = std::move(flat);
    return open;
}

// Cuts the charts as asked; returns the numbers of the parts.
std::vector<Index> cut_apart(const Mesh& mesh, const Cuts& cuts, FlattenResult& result,
                             Progress& progress) {
    std::vector<std::uint8_t> seam = result.charts.seam;
    for (const std::vector<HalfEdge>& cut : cuts) {
        result.cuts += cut.empty() ? 0 : 1;
        for (const HalfEdge h : cut)
            seam[h] = seam[mesh.twin[h]] = 1;
    }
    return take_over(
        mesh,
        atlas::cut_charts_to_disks(
            mesh, atlas::make_chart_map(mesh, result.charts.chart, seam, true), progress)
            .charts,
        cuts, result);
}

// Joins charts. Labels of charts that are joined to others fall out of use until `renumber`.
class Reattachment {
public:
    Reattachment(const Mesh& mesh, FlattenResult& result)
        : mesh_(mesh), defect_(mesh::angle_defects(mesh)), result_(result) {}

    // Parts that were cut off: (area, chart), the smallest first.
    std::vector<std::pair<double, Index>> parts() const {
        std::vector<std::pair<double, Index>> parts;
        for (std::size_t c = 0; c < result_.flat.size(); ++c)
            if (result_.flat[c].cut_off)
                parts.emplace_back(atlas::area_of(mesh_, result_.flat[c].surface),
                                   static_cast<Index>(c));
        std::sort(parts.begin(), parts.end());
        return parts;
    }

    bool glue(Index part, FlattenMethod method, Progress& progress) {
        const std::vector<Index> others =
            atlas::neighbour_labels(mesh_, result_.charts.chart, flat(part).surface);
        return std::any_of(others.begin(), others.end(), [&](Index other) {
            progress.check();
            return try_to_glue(part, other, method, progress);
        });
    }

    bool hinge(Index part, double least) {
        std::vector<std::pair<double, std::vector<HalfEdge>>> hinges;
        std::vector<std::uint8_t> in_hinge(mesh_.twin.size(), 0);
        for (const Face f : flat(part).surface.face)
            for (const HalfEdge h : half_edges_of(f)) {
                if (in_hinge[h] != 0 || !is_border(h, part))
                    continue;
                std::vector<HalfEdge> run = run_through(h, part);
                double length = 0.0;
                for (const HalfEdge k : run) {
                    in_hinge[k] = 1;
                    length += mesh_.edge_length(k);
                }
                if (length >= least)
                    hinges.emplace_back(length, std::move(run));
            }
        std::stable_sort(hinges.begin(), hinges.end(),
                         [](const auto& a, const auto& b) { return a.first > b.first; });
        return std::any_of(hinges.begin(), hinges.end(),
                           [&](const auto& run) { return try_hinge(part, run.second); });
    }

    void renumber() {
        const atlas::ChartMap& charts = result_.charts;
        take_over(mesh_, atlas::make_chart_map(mesh_, charts.chart, charts.seam, false),
                  Cuts(result_.flat.size()), result_);
    }

private:
    FlatChart& flat(Index chart) { return result_.flat[chart]; }

    // Along the whole common border: the map of both is made anew.
    bool try_to_glue(Index part, Index other, FlattenMethod method, Progress& progress) {
        const FlatChart& small = flat(part);
        const FlatChart& large = flat(other);
        std::vector<std::uint8_t> seam = result_.charts.seam;
        FlatChart joined;
        joined.surface = atlas::join_surfaces(mesh_, small.surface, large.surface, seam);
        if (!atlas::is_sound(mesh_, joined.surface))
            return false;
        if ((small.developed || large.developed) && !stays_exact(small, large, joined))
            return false;
        if (!flatten_one(mesh_, method, joined, progress).empty())
            return false;
        const double before = std::max(small.energy, large.energy) - 1.0;
        const double worst =
            std::max({tuning.allowed_stretch, stretch_of(small), stretch_of(large)});
        if (joined.energy - 1.0 > tuning.excess_factor * before + tuning.allowed_excess ||
            stretch_of(joined) > worst)
            return false;
        result_.charts.seam = std::move(seam);
        replace(part, other, std::move(joined));
        return true;
    }

    // What can be folded of paper stays so: small faces close gaps that are not seen, but an angle
    // that is wrong stays wrong.
    bool stays_exact(const FlatChart& small, const FlatChart& large,
                     const FlatChart& joined) const {
        const auto defect_of = [&](const FlatChart& chart) {
            return largest_defect(make_flattening_problem(mesh_, chart.surface));
        };
        return unfold(make_flattening_problem(mesh_, joined.surface)) &&
               defect_of(joined) <= std::max({exact_angle, defect_of(small), defect_of(large)});
    }

    bool is_border(HalfEdge h, Index part) const {
        const HalfEdge twin = mesh_.twin[h];
        return twin >= 0 && result_.charts.chart[face_of(h)] == part &&
               result_.charts.chart[face_of(twin)] != part;
    }

    // The other cut edge at the start of a half-edge, leaving it: where there are two, and exact
    // angles once they are glued. Else none.
    HalfEdge across_start(HalfEdge h) const {
        HalfEdge other;
        int cuts = 0;
        const bool is_inner = mesh::visit_star(mesh_, h, [&](HalfEdge leaving) {
            if (result_.charts.seam[leaving] == 0)
                return;
            ++cuts;
            other = leaving != h ? leaving : other;
        });
        const bool glues =
            is_inner && cuts == 2 && std::abs(defect_[mesh_.origin(h)]) <= exact_angle;
        return glues ? other : HalfEdge();
    }

    // The edge with those before and behind it along the part's border, as far as gluing them all
    // to one neighbour leaves angles exact, as on straight creases: a hinge is mostly one edge.
    std::vector<HalfEdge> run_through(HalfEdge h, Index part) const {
        const Index other = result_.charts.chart[face_of(mesh_.twin[h])];
        const auto goes_on = [&](HalfEdge k) {
            return k >= 0 && k != h && is_border(k, part) &&
                   result_.charts.chart[face_of(mesh_.twin[k])] == other;
        };
        std::vector<HalfEdge> run{h};
        for (HalfEdge k = across_start(mesh_.twin[h]); goes_on(k); k = across_start(mesh_.twin[k]))
            run.push_back(k);
        const auto before = [&](HalfEdge k) {
            const HalfEdge leaving = across_start(k);
            return leaving >= 0 ? HalfEdge(mesh_.twin[leaving]) : leaving;
        };
        // Behind a run that goes all around there is none before it.
        for (HalfEdge k = before(h); goes_on(k) && k != run.back(); k = before(k))
            run.push_back(k);
        return run;
    }

    // Across one edge, or several that leave angles exact: an exact development stays one.
    bool try_hinge(Index part, const std::vector<HalfEdge>& run) {
        const Index other = result_.charts.chart[face_of(mesh_.twin[run.front()])];
        if (!flat(other).developed)
            return false;
        const auto mark = [&](std::uint8_t value) {
            for (const HalfEdge h : run)
                result_.charts.seam[h] = result_.charts.seam[mesh_.twin[h]] = value;
        };
        mark(0);
        std::vector<Index> faces = flat(other).surface.face;
        const std::vector<Index>& added = flat(part).surface.face;
        faces.insert(faces.end(), added.begin(), added.end());
        std::sort(faces.begin(), faces.end());
        FlatChart joined;
        joined.surface = atlas::extract_surface(mesh_, std::move(faces), result_.charts.seam);
        if (!atlas::is_sound(mesh_, joined.surface) || !lies_flat(joined)) {
            mark(1);
            return false;
        }
        joined.cut_off = flat(other).cut_off;
        replace(part, other, std::move(joined));
        return true;
    }

    // Exactly, and not on itself.
    bool lies_flat(FlatChart& chart) const {
        const FlatteningProblem problem = make_flattening_problem(mesh_, chart.surface);
        return develop(mesh_, problem, chart) &&
               overlapping_pairs(chart.surface, chart.uv,
                                 plane::layout_tolerance(problem.model_size))
                   .empty();
    }

    void replace(Index part, Index other, FlatChart joined) {
        for (const Face f : flat(part).surface.face)
            result_.charts.chart[f] = other;
        flat(other) = std::move(joined);
    }

    double stretch_of(const FlatChart& chart) const {
        return largest_stretch(make_flattening_problem(mesh_, chart.surface), chart.uv);
    }

    const Mesh& mesh_;
    std::vector<double> defect_; // #V, radians
    FlattenResult& result_;
};

} // namespace

void hand_over_slivers(const Mesh& mesh, FlattenMethod method, FlattenResult& result,
                       Progress& progress) {
    Reattachment reattachment(mesh, result);
    bool joined = false;
    for (const auto& [area, part] : reattachment.parts())
        if (area < tuning.sliver_share * mesh.model_area())
            joined = reattachment.glue(part, method, progress) || joined;
    if (joined)
        reattachment.renumber();
}

int reattach_parts(const Mesh& mesh, FlattenResult& result, Progress& progress) {
    Reattachment reattachment(mesh, result);
    int number = 0;
    for (const auto& [area, part] : reattachment.parts()) {
        progress.update(0.0);
        const bool is_speck = area < tuning.speck_share * mesh.model_area();
        if (result.flat[part].developed &&
            reattachment.hinge(part, is_speck ? 0.0 : least_hinge * std::sqrt(area)))
            ++number;
    }
    if (number > 0)
        reattachment.renumber();
    return number;
}

std::vector<FlatChart> flatten_whole(const Mesh& mesh, const atlas::ChartMap& charts,
                                     FlattenMethod method, const WholeChart& whole,
                                     Progress& progress) {
    std::vector<FlatChart> flat = without_maps(mesh, charts);
    flatten_some(mesh, method, numbers_of(flat), flat, progress, &whole);
    return flat;
}

FlattenResult flatten_charts(const Mesh& mesh, const atlas::ChartMap& charts, FlattenMethod method,
                             Progress& progress) {
    FlattenResult result;
    result.charts = charts;
    result.flat = without_maps(mesh, charts);
    std::vector<Index> open = numbers_of(result.flat);
    // Every cut makes charts smaller, and a single face overlaps nothing: this ends.
    while (!open.empty()) {
        auto flattening = progress.part(0.75 * progress.left());
        const Cuts cuts = flatten_some(mesh, method, open, result.flat, flattening);
        auto cutting = progress.part(0.1 * progress.left());
        open = cut_apart(mesh, cuts, result, cutting);
    }
    auto handing_over = progress.part(0.3 * progress.left());
    hand_over_slivers(mesh, method, result, handing_over);
    auto reattaching = progress.part(progress.left());
    if (result.cuts > 0)
        result.reattached = reattach_parts(mesh, result, reattaching);
    return result;
}

} // namespace devseg::flatten
