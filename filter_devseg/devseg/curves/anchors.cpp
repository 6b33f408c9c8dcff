#include "devseg/curves/anchors.h"

#include <algorithm>
#include <cmath>

namespace devseg::curves {

namespace {

struct Tuning {
    double near = 0.2; // of an edge: how far from curved vertices curves are drawn to them
};
constexpr Tuning tuning;

} // namespace

Anchors::Anchors(const Network& network, const CurvedVertices& curved)
    : curved_(curved), curve_(network.mesh.points.size(), -1) {}

void Anchors::add_near(const Network& network) {
    std::vector<double> least(curve_.size(), infinite);
    for (const Crossing& c : network.crossings) {
        if (c.curve < 0)
            continue;
        const double length = network.mesh.edge_length(c.edge);
        for (const bool left : {true, false}) {
            const Vertex v = left ? network.mesh.target(c.edge) : network.mesh.origin(c.edge);
            const double away = left ? 1.0 - c.t : c.t;
            if (!curved_.draws_seams(v) || network.occupied[v] != 0 || away > tuning.near ||
                away * length >= least[v])
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
