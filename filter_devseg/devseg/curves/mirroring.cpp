#include "devseg/curves/mirroring.h"

#include <cmath>

namespace devseg::curves {

namespace {

struct Tuning {
    double alike = 0.7; // cosine: images run the same way, one way or the other
};
constexpr Tuning tuning;

} // namespace

Vec3 place_of_crossing(const Network& network, Index crossing) {
    const Crossing& c = network.crossings[crossing];
    const Vec3& a = network.mesh.points[network.mesh.origin(c.edge)];
    return a + c.t * (network.mesh.points[network.mesh.target(c.edge)] - a);
}

Vec3 place_of_node(const Network& network, Index node) {
    const Node& n = network.nodes[node];
    if (!n.is_junction())
        return network.mesh.points[n.vertex];
    const Triangle& t = network.mesh.faces[n.face];
    return n.weights[0] * network.mesh.points[t[0]] + n.weights[1] * network.mesh.points[t[1]] +
           n.weights[2] * network.mesh.points[t[2]];
}

MirrorImage::MirrorImage(const Network& network, const std::vector<Index>& chain,
                         const mesh::MirrorPlane& plane, double reach, double spacing)
    : plane_(plane), reach_(reach) {
    for (std::size_t k = 0; k < network.curves.size(); ++k) {
        const Curve& curve = network.curves[k];
        if (curve.held) {
            for (const HalfEdge h : curve.path)
                add_line(chain[k], network.mesh.points[network.mesh.origin(h)],
                         network.mesh.points[network.mesh.target(h)], spacing);
            continue;
        }
        std::vector<Vec3> way;
        if (curve.start >= 0)
            way.push_back(place_of_node(network, curve.start));
        for (Index c = curve.first; c >= 0; c = network.crossings[c].next) {
            if (c == curve.first && !way.empty() && curve.is_closed())
                break;
            way.push_back(place_of_crossing(network, c));
        }
        if (!curve.is_closed())
            way.push_back(place_of_node(network, curve.end));
        else if (!way.empty())
            way.push_back(way.front());
        for (std::size_t i = 0; i + 1 < way.size(); ++i)
            add_line(chain[k], way[i], way[i + 1], spacing);
    }
    for (Index n = 0; n < static_cast<Index>(network.nodes.size()); ++n)
        junctions_.push_back(plane.reflect(place_of_node(network, n)));
    nearest_.emplace(points_);
    nearest_source_.emplace(sources_);
    nearest_junction_.emplace(junctions_);
}

void MirrorImage::add_line(Index chain, const Vec3& from, const Vec3& to, double spacing) {
    const double length = (to - from).norm();
    if (!(length > 0.0))
        return;
    const int count = 1 + static_cast<int>(length / spacing);
    const Vec3 direction = (plane_.reflect(to) - plane_.reflect(from)) / length;
    for (int k = 0; k < count; ++k) {
        sources_.push_back(from + (k + 0.5) / count * (to - from));
        source_directions_.emplace_back((to - from) / length);
        points_.push_back(plane_.reflect(sources_.back()));
        directions_.push_back(direction);
        chain_.push_back(chain);
    }
}

std::optional<Vec3> MirrorImage::way(Index chain, const Vec3& point, const Vec3& direction) const {
    const auto nearest = [&](const mesh::NearestPoints& points, const std::vector<Vec3>& directions,
                             const Vec3& place) {
        return points.nearest(
            place,
            [&](Index i) { return std::abs(directions[at(i)].dot(direction)) > tuning.alike; },
            reach_);
    };
    const Index k = nearest(*nearest_, directions_, point);
    if (k < 0)
        return {};
    const Index back = nearest(*nearest_source_, source_directions_, points_[at(k)]);
    if (back < 0 || chain_[at(back)] != chain)
        return {};
    const Vec3 d = points_[at(k)] - point; // without what lies along the image
    return Vec3(d - d.dot(directions_[at(k)]) * directions_[at(k)]);
}

std::optional<Vec3> MirrorImage::way_of_junction(const Vec3& point) const {
    const Index k = nearest_junction_->nearest(
        point, [](Index) { return true; }, reach_);
    if (k < 0)
        return {};
    return Vec3(junctions_[at(k)] - point);
}

} // namespace devseg::curves
