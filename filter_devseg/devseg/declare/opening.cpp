#include "devseg/declare/opening.h"

#include <map>
#include <utility>

namespace devseg::declare {

namespace {

// The fan at a corner of a source face; −1 where its stand-in has no corner there.
Index fan_at(const HostMesh& host, const mesh::GatedMesh& gated, const std::vector<Triangle>& fans,
             Index source, Index corner) {
    if (const mesh::CollapsedFace* face = gated.find_collapsed(source)) {
        const HalfEdge h = face->at[at(corner)];
        return h < 0 ? -1 : fans[face_of(h)][at(corner_of(h))];
    }
    const Face f = gated.stand_in[at(source)];
    const Triangle& corners = host.geometry.faces[gated.source_face[f]];
    const bool own = gated.source_face[f] == source;
    for (Index k = 0; k < 3; ++k) {
        const Index to = gated.source_corner(f, k);
        if (own ? to == corner : corners[at(to)] == host.geometry.faces[at(source)][at(corner)])
            return fans[f][at(k)];
    }
    return -1;
}

} // namespace

HostRefinement host_opening(const HostMesh& host, const mesh::GatedMesh& gated,
                            const std::vector<Triangle>& fans) {
    HostRefinement result;
    const auto count = static_cast<Index>(host.geometry.points.size());
    std::vector<Index> first(at(count), -1);         // the fan that keeps the vertex
    std::map<std::pair<Index, Index>, Index> copies; // of a vertex for another fan
    for (Index i = 0; at(i) < host.geometry.faces.size(); ++i) {
        HostRefinement::Part part{
            i, i, host.geometry.faces[at(i)], {Vec3::Unit(0), Vec3::Unit(1), Vec3::Unit(2)}};
        for (Index k = 0; k < 3; ++k) {
            Index& v = part.corners[at(k)];
            const Index fan = fan_at(host, gated, fans, i, k);
            Index& keeper = first[at(v)];
            keeper = keeper < 0 ? fan : keeper;
            if (fan < 0 || fan == keeper)
                continue;
            const auto next = static_cast<Index>(count + static_cast<Index>(result.points.size()));
            const auto [copy, is_new] = copies.try_emplace({v, fan}, next);
            if (is_new)
                result.points.push_back({i, part.weights[at(k)]});
            v = copy->second;
        }
        if (part.corners != host.geometry.faces[at(i)])
            result.parts.push_back(part);
    }
    return result;
}

} // namespace devseg::declare
