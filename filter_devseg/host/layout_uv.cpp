#include "host/layout_uv.h"

#include <algorithm>
#include <cmath>

#include "host/vcg_bridge.h"

namespace devseg::host {

namespace {

// Distance of two texture pages side by side, as a share of their width.
constexpr double page_gap = 0.05;

// Each texture image has a unit square of its own, and charts on two images may share their
// coordinates: the images that are in use are laid side by side.
void spread_pages(const CMeshO& m, std::vector<FaceUv>& uv) {
    std::vector<int> page_of_face;
    page_of_face.reserve(uv.size());
    for (const auto& f : m.face)
        if (!f.IsD())
            page_of_face.push_back(f.cWT(0).N());
    std::vector<int> pages = page_of_face;
    std::sort(pages.begin(), pages.end());
    pages.erase(std::unique(pages.begin(), pages.end()), pages.end());
    if (pages.size() < 2)
        return;
    double low = 0.0;
    double high = 0.0;
    for (const FaceUv& corners : uv)
        for (const Vec2& p : corners)
            if (std::isfinite(p.x())) {
                low = std::min(low, p.x());
                high = std::max(high, p.x());
            }
    const double pitch = (1.0 + page_gap) * (high - low);
    for (std::size_t f = 0; f < uv.size(); ++f) {
        const auto rank =
            std::lower_bound(pages.begin(), pages.end(), page_of_face[f]) - pages.begin();
        for (Vec2& p : uv[f])
            p.x() += pitch * static_cast<double>(rank);
    }
}

// Coordinates at the vertices serve as well: they just have no seams of their own.
std::vector<FaceUv> read_vertex_uv(const CMeshO& m) {
    std::vector<FaceUv> uv;
    uv.reserve(static_cast<std::size_t>(m.fn));
    const auto at_vertex = [](const CVertexO* v) { return Vec2(v->cT().U(), v->cT().V()); };
    for (const auto& f : m.face)
        if (!f.IsD())
            uv.push_back({at_vertex(f.cV(0)), at_vertex(f.cV(1)), at_vertex(f.cV(2))});
    return uv;
}

} // namespace

std::vector<FaceUv> read_layout_uv(const MeshModel& model) {
    if (model.hasDataMask(MeshModel::MM_WEDGTEXCOORD)) {
        std::vector<FaceUv> uv = read_wedge_uv(model.cm);
        spread_pages(model.cm, uv);
        return uv;
    }
    if (model.hasDataMask(MeshModel::MM_VERTTEXCOORD))
        return read_vertex_uv(model.cm);
    return {};
}

} // namespace devseg::host
