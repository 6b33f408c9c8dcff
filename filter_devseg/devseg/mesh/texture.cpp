#include "devseg/mesh/texture.h"

namespace devseg {

namespace {
// Writers of texture coordinates round to 6 digits: smaller differences are no seams.
constexpr double seam_tolerance = 1e-6;
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
        return !((uv[at(a)] - uv[at(b)]).cwiseAbs().maxCoeff() <= tolerance);
    };
    std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    for (Index h = 0; h < mesh.half_edge_count(); ++h) {
        const Index opposite = mesh.twin[at(h)];
        if (opposite >= 0)
            seam[at(h)] =
                differ(h, Mesh::next(opposite)) || differ(Mesh::next(h), opposite) ? 1 : 0;
    }
    return make_chart_map(mesh, std::vector<Index>(mesh.faces.size(), 0), seam, true);
}

double uv_area(const CornerUv& uv, Index f) {
    const Vec2 p = uv[at(3 * f + 1)] - uv[at(3 * f)];
    const Vec2 q = uv[at(3 * f + 2)] - uv[at(3 * f)];
    return 0.5 * (p.x() * q.y() - p.y() * q.x());
}

} // namespace devseg
