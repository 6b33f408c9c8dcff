#include "devseg/flatten/reattach.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/rest_shape.h"
#include "devseg/flatten/maps/unfold.h"
#include "devseg/flatten/one_chart.h"
#include "devseg/flatten/repair/overlaps.h"

namespace devseg::flatten {

namespace {

constexpr double sliver_share = 0.01; // of the mesh's area: smaller parts are slivers
// What a joined map may lose: excess of its energy, as a share of the mesh's area, and the stretch
// of its worst face, which may in any case be as high as that of the parts.
constexpr double allowed_excess = 2e-4;
constexpr double allowed_stretch = 1.5;
constexpr double least_hinge = 0.3; // length of the edge over the root of the part's area

// Joins charts. Labels of charts that are joined to others fall out of use until `renumber`.
class Reattachment {
public:
    Reattachment(const Mesh& mesh, double tolerance, FlattenResult& result)
        : mesh_(mesh), tolerance_(tolerance), result_(result) {}

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
        std::vector<std::pair<double, Index>> hinges;
        for (const Face f : flat(part).surface.face)
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = mesh_.twin[h];
                if (twin >= 0 && result_.charts.chart[twin / 3] != part &&
                    mesh_.edge_length(h) >= least)
                    hinges.emplace_back(mesh_.edge_length(h), h);
            }
        std::sort(hinges.begin(), hinges.end(), std::greater<>());
        return std::any_of(hinges.begin(), hinges.end(),
                           [&](const auto& edge) { return try_hinge(part, edge.second); });
    }

    // Numbers in the order of first faces, as everywhere.
    void renumber() {
        std::vector<FlatChart> flat;
        const std::vector<Index> old = result_.charts.chart;
        result_.charts = atlas::make_chart_map(mesh_, old, result_.charts.seam, false);
        for (const atlas::ChartSurface& surface : atlas::extract_charts(mesh_, result_.charts))
            flat.push_back(std::move(result_.flat[old[surface.face.front()]]));
        result_.flat = std::move(flat);
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
        if (!joined.surface.is_disk())
            return false;
        // What can be folded of paper stays so.
        if ((small.developed || large.developed) &&
            !unfold(make_flattening_problem(mesh_, joined.surface), joined.surface.twin))
            return false;
        if (!flatten_one(mesh_, method, tolerance_, joined, progress).empty())
            return false;
        const double before = excess_of(small) + excess_of(large);
        const double worst =
            std::max({allowed_stretch, largest_stretch(small), largest_stretch(large)});
        if (excess_of(joined) > before + allowed_excess * mesh_.total_area ||
            largest_stretch(joined) > worst)
            return false;
        result_.charts.seam = std::move(seam);
        replace(part, other, std::move(joined));
        return true;
    }

    // Across one edge: an exact development stays one.
    bool try_hinge(Index part, HalfEdge h) {
        const HalfEdge twin = mesh_.twin[h];
        const Index other = result_.charts.chart[twin / 3];
        if (!flat(other).developed)
            return false;
        std::vector<std::uint8_t>& seam = result_.charts.seam;
        seam[h] = seam[twin] = 0;
        std::vector<Index> faces = flat(other).surface.face;
        const std::vector<Index>& added = flat(part).surface.face;
        faces.insert(faces.end(), added.begin(), added.end());
        std::sort(faces.begin(), faces.end());
        FlatChart joined;
        joined.surface = atlas::extract_surface(mesh_, std::move(faces), seam);
        if (!develop(mesh_, make_flattening_problem(mesh_, joined.surface), joined) ||
            !overlapping_pairs(joined.surface, joined.uv, tolerance_).empty()) {
            seam[h] = seam[twin] = 1;
            return false;
        }
        joined.cut_off = flat(other).cut_off;
        replace(part, other, std::move(joined));
        return true;
    }

    void replace(Index part, Index other, FlatChart joined) {
        for (const Face f : flat(part).surface.face)
            result_.charts.chart[f] = other;
        flat(other) = std::move(joined);
    }

    double excess_of(const FlatChart& chart) const {
        return (chart.energy - 1.0) * atlas::area_of(mesh_, chart.surface);
    }

    double largest_stretch(const FlatChart& chart) const {
        const FlatteningProblem problem = make_flattening_problem(mesh_, chart.surface);
        double largest = 1.0;
        for (std::size_t f = 0; f < problem.faces.size(); ++f)
            largest = std::max(largest, face_stretch(problem, chart.uv, f));
        return largest;
    }

    const Mesh& mesh_;
    double tolerance_;
    FlattenResult& result_;
};

} // namespace

void hand_over_slivers(const Mesh& mesh, FlattenMethod method, double tolerance,
                       FlattenResult& result, Progress& progress) {
    Reattachment reattachment(mesh, tolerance, result);
    bool joined = false;
    for (const auto& [area, part] : reattachment.parts())
        if (area < sliver_share * mesh.total_area)
            joined = reattachment.glue(part, method, progress) || joined;
    if (joined)
        reattachment.renumber();
}

int reattach_parts(const Mesh& mesh, double tolerance, FlattenResult& result, Progress& progress) {
    Reattachment reattachment(mesh, tolerance, result);
    int number = 0;
    for (const auto& [area, part] : reattachment.parts()) {
        progress.update(0.0);
        if (result.flat[part].developed && reattachment.hinge(part, least_hinge * std::sqrt(area)))
            ++number;
    }
    if (number > 0)
        reattachment.renumber();
    return number;
}

} // namespace devseg::flatten
