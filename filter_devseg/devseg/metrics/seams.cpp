#include "devseg/metrics/seams.h"

#include <map>
#include <utility>

namespace devseg::metrics {

std::vector<SeamMeasures> measure_seams(const Mesh& mesh, const atlas::ChartMap& charts,
                                        const CornerUv& uv) {
    const double scale = atlas::layout_scale(mesh, charts, uv) * mesh.unit_length;
    const auto flat_length = [&](HalfEdge h) { return scale * (uv[Mesh::next(h)] - uv[h]).norm(); };
    std::map<std::pair<Index, Index>, SeamMeasures> seams;
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge twin = mesh.twin[h];
        if (charts.seam[h] == 0 || h > twin)
            continue;
        Index a = h; // the side in the chart with the lower number
        Index b = twin;
        if (charts.chart[a / 3] > charts.chart[b / 3])
            std::swap(a, b);
        const std::pair<Index, Index> key(charts.chart[a / 3], charts.chart[b / 3]);
        SeamMeasures& seam = seams[key];
        seam.chart_a = key.first;
        seam.chart_b = key.second;
        seam.surface_length += mesh.edge_length(h) * mesh.unit_length;
        seam.length_a += flat_length(a);
        seam.length_b += flat_length(b);
    }
    std::vector<SeamMeasures> result;
    for (const auto& [key, seam] : seams)
        result.push_back(seam);
    return result;
}

} // namespace devseg::metrics
