#include "devseg/declare/refined_faces.h"

#include <algorithm>
#include <map>

namespace devseg::declare {

namespace {

// Barycentric coordinates in the host's face, whose last corners may be swapped.
Vec3 of_source_corners(const mesh::GatedMesh& gated, Face f, const Vec3& weights) {
    Vec3 turned;
    for (Index k = 0; k < 3; ++k)
        turned[gated.source_corner(f, k)] = weights[k];
    return turned;
}

// Whether no two faces share a vertex, as in files such as STL.
bool is_soup(const mesh::RawMesh& raw) {
    std::vector<std::uint8_t> used(raw.points.size(), 0);
    for (const Triangle& t : raw.faces)
        for (const Vertex v : t) {
            if (used[v] != 0)
                return false;
            used[v] = 1;
        }
    return true;
}

// Vertices of the host's parts. They share those that their faces share; on an edge whose faces
// have vertices of their own, which the gate has joined, the first gets the new vertex, and the
// others copies of it. In a soup each part gets its own: else the host would no longer join them.
class PartVertices {
public:
    PartVertices(const HostMesh& host, const mesh::GatedMesh& gated, const mesh::Refinement& fine,
                 std::vector<HostRefinement::Point>& points)
        : host_(host), gated_(gated), fine_(fine), is_soup_(is_soup(host.geometry)),
          points_(points) {
        if (is_soup_)
            return;
        for (const mesh::Refinement::Point& p : fine.points)
            points.push_back(host_point(p));
        owner_.assign(fine.points.size(), Edge{-1, -1});
    }

    // Of vertex v at a place in the part's face, by the weights of the host's corners. `is_first`:
    // the part takes the place of its face.
    Index vertex(Index v, const mesh::Refinement::Part& part, bool is_first, const Vec3& weights) {
        const Index source = gated_.source_face[part.source];
        const Triangle& corners = host_.geometry.faces[source];
        const auto old_count = static_cast<Index>(gated_.mesh.points.size());
        if (v < old_count) {
            Index corner = -1;
            weights.maxCoeff(&corner);
            return is_soup_ && !is_first ? added({source, weights}) : corners[at(corner)];
        }
        // The same place for all, to the last bit.
        const HostRefinement::Point point = host_point(fine_.points[at(v - old_count)]);
        if (is_soup_)
            return added(point);
        const Edge edge = edge_at(corners, weights);
        Edge& owner = owner_[at(v - old_count)];
        if (owner[0] < 0)
            owner = edge;
        if (owner == edge)
            return host_count() + v - old_count;
        const auto known = copies_.find({v, edge});
        return known != copies_.end() ? known->second : copies_[{v, edge}] = added(point);
    }

private:
    using Edge = std::array<Index, 2>; // of the host's vertices, the lower one first

    Index host_count() const { return static_cast<Index>(host_.geometry.points.size()); }

    HostRefinement::Point host_point(const mesh::Refinement::Point& p) const {
        return {gated_.source_face[p.face], of_source_corners(gated_, p.face, p.weights)};
    }

    // Points inside of a face belong to it alone: any edge of it says so.
    static Edge edge_at(const Triangle& corners, const Vec3& weights) {
        Index opposite = 0;
        weights.minCoeff(&opposite);
        opposite = weights[opposite] == 0.0 ? opposite : 0;
        const auto [low, high] =
            std::minmax({corners[at((opposite + 1) % 3)], corners[at((opposite + 2) % 3)]});
        return {low, high};
    }

    Index added(const HostRefinement::Point& point) {
        points_.push_back(point);
        return host_count() + static_cast<Index>(points_.size()) - 1;
    }

    const HostMesh& host_;
    const mesh::GatedMesh& gated_;
    const mesh::Refinement& fine_;
    bool is_soup_;
    std::vector<HostRefinement::Point>& points_;
    std::vector<Edge> owner_; // of each new vertex, on its first side
    std::map<std::pair<Index, Edge>, Index> copies_;
};

} // namespace

HostRefinement host_refinement(const HostMesh& host, const mesh::GatedMesh& gated,
                               const mesh::Refinement& fine,
                               const std::vector<const mesh::Refinement::Part*>& parts) {
    HostRefinement result;
    PartVertices vertices(host, gated, fine, result.points);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (parts[i] == nullptr)
            continue;
        const mesh::Refinement::Part& part = *parts[i];
        HostRefinement::Part out{static_cast<Index>(i), gated.source_face[part.source], {}, {}};
        for (Index k = 0; k < 3; ++k) {
            const std::size_t to = at(gated.source_corner(part.source, k));
            out.weights[to] = of_source_corners(gated, part.source, part.corners[at(k)]);
            out.corners[to] = vertices.vertex(fine.mesh.faces[part.face][at(k)], part,
                                              i < host.geometry.faces.size(), out.weights[to]);
        }
        result.parts.push_back(out);
    }
    return result;
}

} // namespace devseg::declare
