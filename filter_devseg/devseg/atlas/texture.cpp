#include "devseg/atlas/texture.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace devseg::atlas {

namespace {
// Writers of texture coordinates round to 6 digits: smaller differences are no seams.
constexpr double seam_tolerance = 1e-6;
// Charts whose boundary lengths agree to this share were flattened to keep them. Coordinates of 32
// bit change the length of a short boundary by about a tenth of that.
constexpr double same_length = 1e-4;
} // namespace

ChartMap charts_from_uv(const Mesh& mesh, const CornerUv& uv) {
    Vec2 low = uv.front();
    Vec2 high = uv.front();
    for (const Vec2& p : uv) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    const double tolerance = seam_tolerance * (high - low).norm();
    const auto differ = [&](Index a, Index b) {
        return !((uv[a] - uv[b]).cwiseAbs().maxCoeff() <= tolerance);
    };
    std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge opposite = mesh.twin[h];
        if (opposite >= 0)
            seam[h] = differ(h, Mesh::next(opposite)) || differ(Mesh::next(h), opposite) ? 1 : 0;
    }
    return make_chart_map(mesh, std::vector<Index>(mesh.faces.size(), 0), seam, true);
}

double layout_scale(const Mesh& mesh, const ChartMap& charts, const CornerUv& uv) {
    std::vector<double> surface(at(charts.count), 0.0); // boundary lengths of the charts
    std::vector<double> plane(at(charts.count), 0.0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] < 0 || charts.seam[h] != 0) {
            const Index c = charts.chart[face_of(h)];
            surface[c] += mesh.edge_length(h);
            plane[c] += (uv[Mesh::next(h)] - uv[h]).norm();
        }
    double least = infinite;
    double most = 0.0;
    double all_surface = 0.0;
    double all_plane = 0.0;
    for (std::size_t c = 0; c < surface.size(); ++c) {
        const double scale = plane[c] > 0.0 ? surface[c] / plane[c] : 0.0;
        least = std::min(least, scale);
        most = std::max(most, scale);
        all_surface += surface[c];
        all_plane += plane[c];
    }
    if (least > 0.0 && most <= (1.0 + same_length) * least)
        return all_surface / all_plane;
    double area = 0.0;
    for (const Face f : mesh.all_faces())
        area += std::abs(plane::uv_area(uv, f));
    return area > 0.0 ? std::sqrt(mesh.total_area / area) : 0.0;
}

std::vector<Vec2> read_map(const ChartSurface& surface, const CornerUv& uv, const Vec2& scale) {
    std::vector<Vec2> map(surface.vertex.size());
    for (const HalfEdge h : surface.all_half_edges())
        map[surface.origin(h)] = scale.cwiseProduct(uv[surface.mesh_half_edge(h)]);
    return map;
}

} // namespace devseg::atlas
