#include "devseg/curves/strip.h"

#include <cmath>

namespace devseg::curves {

namespace {

// A face in the plane.
struct FlatFace {
    Face face;
    std::array<Vec2, 3> corners;

    Vec2 at_vertex(const Mesh& mesh, Vertex v) const {
        for (std::size_t k = 0; k < 3; ++k)
            if (mesh.faces[face][k] == v)
                return corners[k];
        return corners[0];
    }
};

// The third corner of h's face, on the left of a → b, the place of h.
Vec2 place_apex(const Mesh& mesh, HalfEdge h, const Vec2& a, const Vec2& b) {
    const Vec3& origin = mesh.points[mesh.origin(h)];
    const Vec3 edge = mesh.points[mesh.target(h)] - origin;
    const Vec3 side = mesh.points[mesh.apex(h)] - origin;
    const double length = edge.norm();
    if (!(length > 0.0))
        return a + Vec2(side.norm(), 0.0);
    const Vec2 flat = (b - a).norm() > 0.0 ? Vec2((b - a).normalized()) : Vec2::UnitX();
    return a + edge.dot(side) / length * flat +
           edge.cross(side).norm() / length * Vec2(-flat.y(), flat.x());
}

FlatFace place_face(const Mesh& mesh, HalfEdge h, const Vec2& a, const Vec2& b) {
    FlatFace flat{face_of(h), {}};
    flat.corners[at(corner_of(h))] = a;
    flat.corners[at(corner_of(Mesh::next(h)))] = b;
    flat.corners[at(corner_of(Mesh::previous(h)))] = place_apex(mesh, h, a, b);
    return flat;
}

Face first_face(const Network& net, const std::vector<Stop>& stops) {
    for (const Stop& stop : stops) {
        if (stop.crossing >= 0)
            return face_of(stop.leaving);
        if (net.nodes[stop.node].is_junction())
            return net.nodes[stop.node].face;
    }
    return Face();
}

} // namespace

std::vector<FlatStop> unfold(const Network& net, const std::vector<Stop>& stops) {
    const Mesh& mesh = net.mesh;
    const HalfEdge h0 = half_edge_of(first_face(net, stops), 0);
    FlatFace flat = place_face(mesh, h0, Vec2::Zero(), Vec2(mesh.edge_length(h0), 0.0));
    std::vector<FlatStop> result;
    result.reserve(stops.size());
    for (const Stop& stop : stops) {
        FlatStop place;
        if (stop.crossing >= 0) {
            const HalfEdge h = stop.leaving;
            place.right = flat.corners[at(corner_of(h))];
            place.left = flat.corners[at(corner_of(Mesh::next(h)))];
            place.point = place.right + net.position(stop.crossing, h) * (place.left - place.right);
            flat = place_face(mesh, mesh.twin[h], place.left, place.right);
        } else {
            const Node& node = net.nodes[stop.node];
            place.corners = flat.corners;
            place.point = node.is_junction() ? Vec2(node.weights[0] * flat.corners[0] +
                                                    node.weights[1] * flat.corners[1] +
                                                    node.weights[2] * flat.corners[2])
                                             : flat.at_vertex(mesh, node.vertex);
        }
        if (!result.empty())
            place.along = result.back().along + (place.point - result.back().point).norm();
        result.push_back(place);
    }
    return result;
}

} // namespace devseg::curves
