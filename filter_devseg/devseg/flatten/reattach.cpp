#include "devseg/flatten/reattach.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include "devseg/develop/unfold.h"
#include "devseg/flatten/map_tools.h"
#include "devseg/flatten/overlaps.h"

namespace devseg {

namespace {

constexpr double least_hinge = 0.3; // length of the edge over the root of the part's area

class Reattachment {
public:
    Reattachment(const Mesh& mesh, double tolerance, FlattenResult& result)
        : mesh_(mesh), tolerance_(tolerance), result_(result) {}

    int run(Progress& progress) {
        std::vector<Index> parts(result_.flat.size());
        std::iota(parts.begin(), parts.end(), 0);
        std::vector<double> area(parts.size(), 0.0);
        for (std::size_t c = 0; c < parts.size(); ++c)
            for (const Index f : result_.flat[c].surface.face)
                area[c] += mesh_.face_areas[at(f)];
        std::stable_sort(parts.begin(), parts.end(),
                         [&](Index a, Index b) { return area[at(a)] < area[at(b)]; });
        int number = 0;
        for (const Index part : parts) {
            progress.update(0.0);
            if (result_.flat[at(part)].cut_off && result_.flat[at(part)].developed)
                number += attach(part, least_hinge * std::sqrt(area[at(part)])) ? 1 : 0;
        }
        if (number > 0)
            renumber();
        return number;
    }

private:
    bool attach(Index part, double least) {
        std::vector<std::pair<double, Index>> hinges;
        for (const Index f : result_.flat[at(part)].surface.face)
            for (Index h = 3 * f; h < 3 * f + 3; ++h) {
                const Index twin = mesh_.twin[at(h)];
                if (twin >= 0 && result_.charts.chart[at(twin / 3)] != part &&
                    mesh_.edge_length(h) >= least)
                    hinges.emplace_back(mesh_.edge_length(h), h);
            }
        std::sort(hinges.begin(), hinges.end(), std::greater<>());
        return std::any_of(hinges.begin(), hinges.end(),
                           [&](const auto& hinge) { return try_hinge(part, hinge.second); });
    }

    bool try_hinge(Index part, Index h) {
        const Index twin = mesh_.twin[at(h)];
        const Index other = result_.charts.chart[at(twin / 3)];
        if (!result_.flat[at(other)].developed)
            return false;
        std::vector<std::uint8_t>& seam = result_.charts.seam;
        seam[at(h)] = seam[at(twin)] = 0;
        std::vector<Index> faces = result_.flat[at(other)].surface.face;
        const std::vector<Index>& added = result_.flat[at(part)].surface.face;
        faces.insert(faces.end(), added.begin(), added.end());
        std::sort(faces.begin(), faces.end());
        FlatChart joined;
        joined.surface = extract_surface(mesh_, std::move(faces), seam);
        if (!develop(joined)) {
            seam[at(h)] = seam[at(twin)] = 1;
            return false;
        }
        joined.cut_off = result_.flat[at(other)].cut_off;
        for (const Index f : added)
            result_.charts.chart[at(f)] = other;
        result_.flat[at(other)] = std::move(joined);
        return true;
    }

    bool develop(FlatChart& chart) const {
        const FlatteningProblem problem = make_flattening_problem(mesh_, chart.surface);
        auto development = unfold(problem, chart.surface.twin);
        if (!development)
            return false;
        chart.uv = std::move(*development);
        scale_to_area(problem, chart.uv);
        chart.developed = true;
        chart.energy = 1.0;
        return overlapping_pairs(chart.surface, chart.uv, tolerance_).empty();
    }

    // Numbers in the order of first faces, as everywhere.
    void renumber() {
        std::vector<FlatChart> flat;
        const std::vector<Index> old = result_.charts.chart;
        result_.charts = make_chart_map(mesh_, old, result_.charts.seam, false);
        for (const ChartSurface& surface : extract_charts(mesh_, result_.charts))
            flat.push_back(std::move(result_.flat[at(old[at(surface.face.front())])]));
        result_.flat = std::move(flat);
    }

    const Mesh& mesh_;
    double tolerance_;
    FlattenResult& result_;
};

} // namespace

int reattach_parts(const Mesh& mesh, double tolerance, FlattenResult& result, Progress& progress) {
    return Reattachment(mesh, tolerance, result).run(progress);
}

} // namespace devseg
