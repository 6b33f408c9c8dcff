#include "devseg/declare/collapsed_faces.h"

#include <cmath>
#include <limits>

#include "devseg/plane/plane.h"

namespace devseg::declare {

int edge_bits(double value) {
    return value >= 0.0 && value <= 7.0 ? static_cast<int>(std::lround(value)) : 0;
}

void set_collapsed_seams(const mesh::GatedMesh& gated, const HostMesh& host,
                         const std::vector<std::uint8_t>& cut, HostResult& result) {
    const auto stays = [&](Index source) {
        return !result.untouched.empty() && result.untouched[source] != 0;
    };
    for (const mesh::CollapsedFace& face : gated.collapsed) {
        const bool is_old = stays(face.source) && !host.seam_edges.empty();
        int bits = is_old ? edge_bits(host.seam_edges[face.source]) : 0;
        for (std::size_t e = 0; e < 3; ++e) {
            bool is_cut = false;
            if (const HalfEdge h = face.beside[e]; h >= 0) {
                if (is_old && stays(gated.source_face[face_of(h)]))
                    continue;
                is_cut = cut[h] != 0;
            } else if (is_old) {
                continue;
            } else if (face.next[e] >= 0) {
                is_cut = result.chart_id[face.source] !=
                         result.chart_id[gated.collapsed[face.next[e]].source];
            }
            bits = is_cut ? bits | 1 << e : bits & ~(1 << e);
        }
        result.seam_edges[face.source] = bits;
    }
}

CollapsedCorners::CollapsedCorners(const mesh::GatedMesh& gated, const CornerUv& uv)
    : gated_(gated), uv_(uv), middle_(plane::box_of(uv).center()) {
    double largest = 0.0;
    for (const Vec2& p : uv)
        largest = std::max(largest, p.cwiseAbs().maxCoeff());
    const auto single = static_cast<float>(largest);
    step_ = std::nextafter(single, std::numeric_limits<float>::infinity()) - single;
}

// Corners that the stand-in does not have lie at the first that it has.
std::array<Vec2, 3> CollapsedCorners::of(const mesh::CollapsedFace& face) const {
    const Face f = gated_.stand_in[face.source];
    HalfEdge otherwise = half_edge_of(f, 0);
    for (std::size_t k = 3; k-- > 0;)
        if (face.at[k] >= 0)
            otherwise = face.at[k];
    std::array<Vec2, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
        corners[k] = uv_[face.at[k] >= 0 ? face.at[k] : otherwise];
    return widened(corners, gated_.flipped[f] != 0);
}

// One corner moves by a step, towards the middle of the layout; of three at one place two.
std::array<Vec2, 3> CollapsedCorners::widened(std::array<Vec2, 3> corners, bool is_flipped) const {
    const auto inwards = [&](const Vec2& p, Index axis) -> Vec2 {
        return (p[axis] < middle_[axis] ? step_ : -step_) * Vec2::Unit(axis);
    };
    const double sign = is_flipped ? -1.0 : 1.0;
    for (std::size_t i = 0; i < 3; ++i) {
        Vec2& first = corners[i];
        Vec2& second = corners[(i + 1) % 3];
        const Vec2 away = corners[(i + 2) % 3] - first;
        if (first != second || away.isZero(0.0))
            continue;
        const Vec2 move = inwards(first, std::abs(away.y()) >= std::abs(away.x()) ? 0 : 1);
        (sign * plane::cross(move, away) > 0.0 ? second : first) += move;
        return corners;
    }
    if (corners[0] == corners[1] && corners[1] == corners[2]) {
        const Vec2 x = inwards(corners[0], 0);
        const Vec2 y = inwards(corners[0], 1);
        const bool turns_left = sign * plane::cross(x, y) > 0.0;
        corners[1] += turns_left ? x : y;
        corners[2] += turns_left ? y : x;
    }
    return corners;
}

} // namespace devseg::declare
