#include "devseg/declare/segmentation_output.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include "devseg/metrics/segmentation.h"

namespace devseg::declare {

namespace {

// Light enough for black text, far apart from one another also for colour-blind eyes; after
// P. Tol: Colour Schemes (SRON, 2021), the muted and light schemes.
constexpr std::array<Color, 14> palette{{{{119, 170, 221}},
                                         {{238, 136, 102}},
                                         {{68, 187, 153}},
                                         {{238, 221, 136}},
                                         {{255, 170, 187}},
                                         {{153, 221, 255}},
                                         {{187, 204, 51}},
                                         {{170, 68, 153}},
                                         {{221, 204, 119}},
                                         {{136, 204, 238}},
                                         {{204, 102, 119}},
                                         {{170, 170, 0}},
                                         {{153, 153, 221}},
                                         {{221, 221, 221}}}};

std::vector<Color> choose_colors(const Mesh& mesh, const atlas::ChartMap& charts,
                                 const std::vector<std::optional<Color>>& given) {
    const std::size_t count = at(charts.count);
    std::vector<std::set<Index>> neighbours(count);
    std::vector<double> area(count, 0.0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index c = charts.chart[h / 3];
        area[c] += mesh.face_areas[h / 3] / 3.0;
        if (mesh.twin[h] >= 0 && charts.chart[mesh.twin[h] / 3] != c)
            neighbours[c].insert(charts.chart[mesh.twin[h] / 3]);
    }
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return area[a] > area[b]; });
    std::vector<std::size_t> chosen(count, palette.size());
    std::array<std::size_t, palette.size()> uses{};
    for (std::size_t c = 0; c < given.size(); ++c) // other colours than these are far enough
        if (given[c])
            chosen[c] = static_cast<std::size_t>(
                std::find(palette.begin(), palette.end(), *given[c]) - palette.begin());
    for (const std::size_t c : order) {
        if (c < given.size() && given[c])
            continue;
        std::array<bool, palette.size()> taken{};
        for (const Index n : neighbours[c])
            if (chosen[n] < palette.size())
                taken[chosen[n]] = true;
        // The least used free colour keeps charts apart that only look like neighbours.
        std::size_t best = palette.size();
        for (std::size_t i = 0; i < palette.size(); ++i)
            if (!taken[i] && (best == palette.size() || uses[i] < uses[best]))
                best = i;
        chosen[c] = best < palette.size() ? best : 0;
        ++uses[chosen[c]];
    }
    std::vector<Color> colors;
    for (std::size_t c = 0; c < count; ++c)
        colors.push_back(c < given.size() && given[c] ? *given[c] : palette[chosen[c]]);
    return colors;
}

} // namespace

std::vector<Color> chart_colors(const Mesh& mesh, const atlas::ChartMap& charts) {
    return choose_colors(mesh, charts, {});
}

std::vector<Color> face_chart_colors(const Mesh& mesh, const atlas::ChartMap& charts) {
    return face_chart_colors(mesh, charts, {});
}

std::vector<Color> face_chart_colors(const Mesh& mesh, const atlas::ChartMap& charts,
                                     const std::vector<std::optional<Color>>& given) {
    const std::vector<Color> colors = choose_colors(mesh, charts, given);
    std::vector<Color> result;
    result.reserve(charts.chart.size());
    for (const Index c : charts.chart)
        result.push_back(colors[c]);
    return result;
}

FilterOutput chart_output(const Mesh& mesh, atlas::ChartMap charts, std::vector<double> quality,
                          ResultValues values) {
    FilterOutput output;
    output.values = std::move(values);
    output.face_color = face_chart_colors(mesh, charts);
    output.face_quality = std::move(quality);
    output.charts = std::move(charts);
    return output;
}

void select_charts(const std::vector<std::uint8_t>& charts, FilterOutput& output) {
    if (std::none_of(charts.begin(), charts.end(), [](auto chosen) { return chosen != 0; }))
        return;
    for (const Index c : output.charts->chart)
        output.selected.push_back(charts[c]);
}

FilterOutput segmentation_output(const FilterInput& input, const std::vector<Index>& labels,
                                 std::vector<double> face_quality,
                                 const atlas::DiskOptions& options, Progress& progress) {
    auto cutting = progress.part("cutting charts to disks", 1.0);
    atlas::DiskCuts cuts = atlas::cut_charts_to_disks(
        input.mesh, atlas::make_chart_map(input.mesh, labels, {}, false), options, cutting);
    ResultValues values = {{"charts_number", cuts.charts.count},
                           {"cut_length", cuts.cut_length * input.mesh.unit_length},
                           {"seam_length", metrics::seam_length(input.mesh, cuts.charts)}};
    return chart_output(input.mesh, std::move(cuts.charts), std::move(face_quality),
                        std::move(values));
}

} // namespace devseg::declare
