#include "devseg/curves/anchors.h"

#include <algorithm>
#include <cmath>

#include "devseg/mesh/angle_defects.h"

namespace devseg::curves {

namespace {

struct Tuning {
    double sharp = 40.0 * degrees;  // curvature of vertices that seams never leave
    double curved = 15.0 * degrees; // and of those that they go back to
    double firm = 2.0 * degrees;    // the same near firm seams, which never leave the former
    double near = 0.2;              // of an edge: how far from these curves are drawn to them
};
constexpr Tuning tuning;

// The vertices of faces that touch a firm seam: curves that leave it stay among them for long.
std::vector<std::uint8_t> vertices_near(const Mesh& mesh, const std::vector<std::uint8_t>& firm) {
    std::vector<std::uint8_t> on(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (firm[h] != 0)
            on[mesh.origin(h)] = on[mesh.target(h)] = 1;
    std::vector<std::uint8_t> near = on;
    for (const HalfEdge h : mesh.all_half_edges())
        if (on[mesh.origin(h)] != 0)
            near[mesh.target(h)] = near[mesh.origin(Mesh::previous(h))] = 1;
    return near;
}

} // namespace

Anchors::Anchors(const Network& network, const std::vector<std::uint8_t>& firm)
    : defect_(mesh::angle_defects(network.mesh)), firm_(vertices_near(network.mesh, firm)),
      curve_(network.mesh.points.size(), -1) {
    for (double& d : defect_)
        d = std::abs(d);
    for (Index c = 0; c < static_cast<Index>(network.curves.size()); ++c) {
        const Curve& curve = network.curves[c];
        for (std::size_t i = curve.is_closed() ? 0 : 1; !curve.held && i < curve.path.size(); ++i) {
            const Vertex v = network.mesh.origin(curve.path[i]);
            if (defect_[v] > (firm_[v] != 0 ? tuning.firm : tuning.sharp))
                curve_[v] = c;
        }
    }
}

void Anchors::add_near(const Network& network) {
    std::vector<double> least(curve_.size(), infinite);
    for (const Crossing& c : network.crossings) {
        if (c.curve < 0)
            continue;
        const double length = network.mesh.edge_length(c.edge);
        for (const bool left : {true, false}) {
            const Vertex v = left ? network.mesh.target(c.edge) : network.mesh.origin(c.edge);
            const double away = left ? 1.0 - c.t : c.t;
            const double curved = firm_[v] != 0 ? tuning.firm : tuning.curved;
            if (defect_[v] < curved || network.occupied[v] != 0 || away > tuning.near ||
                (curve_[v] >= 0 && least[v] == infinite) || away * length >= least[v])
                continue;
            least[v] = away * length;
            curve_[v] = c.curve;
        }
    }
}

std::vector<Hold> Anchors::holds(const Network& network, const std::vector<Stop>& stops,
                                 const std::vector<FlatStop>& flat) const {
    std::vector<Hold> holds;
    for (const bool left : {true, false})
        add_holds(network, stops, flat, left, holds);
    return holds;
}

// All stops on the edges of one vertex follow each other: the nearest place among them counts.
void Anchors::add_holds(const Network& network, const std::vector<Stop>& stops,
                        const std::vector<FlatStop>& flat, bool left,
                        std::vector<Hold>& holds) const {
    Vertex current;
    double least = infinite;
    const auto look = [&](std::size_t i, std::size_t k, const Vec2& place) {
        const Vec2 step = flat[k].point - flat[i].point;
        const double squared = step.squaredNorm();
        const double s =
            squared > 0.0 ? std::clamp((place - flat[i].point).dot(step) / squared, 0.0, 1.0) : 0.0;
        const Vec2 shift = place - flat[i].point - s * step;
        if (shift.squaredNorm() >= least)
            return;
        least = shift.squaredNorm();
        holds.back() = {flat[i].along + s * (flat[k].along - flat[i].along), shift};
    };
    for (std::size_t i = 0; i < stops.size(); ++i) {
        Vertex v;
        if (stops[i].crossing >= 0) {
            v = left ? network.mesh.target(stops[i].leaving)
                     : network.mesh.origin(stops[i].leaving);
            if (curve_[v] != network.crossings[stops[i].crossing].curve)
                v = Vertex();
        }
        if (v >= 0 && v != current) {
            holds.emplace_back();
            least = infinite;
        }
        current = v;
        if (v < 0)
            continue;
        const Vec2& place = left ? flat[i].left : flat[i].right;
        if (i > 0)
            look(i - 1, i, place);
        if (i + 1 < stops.size())
            look(i, i + 1, place);
    }
}

} // namespace devseg::curves
