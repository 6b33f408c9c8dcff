#include "devseg/curves/smoothing.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "devseg/curves/anchors.h"
#include "devseg/curves/bending.h"
#include "devseg/curves/chains.h"
#include "devseg/curves/mirroring.h"
#include "devseg/curves/strip.h"

namespace devseg::curves {

namespace {

struct Tuning {
    double farthest_end = 0.999; // of an edge: how near crossings come to its ends
    double margin = 6.0;         // scales: how far closed curves are smoothed beyond their ends
    double apart = 0.01;         // of an edge: how near curves come to each other on it
    double inside = 0.05;        // barycentric: how near junctions come to the edges of a face
    double image = 2.0;          // scales: how far from each other mirror images lie at most
    double image_spacing = 0.25; // scales: of the points along mirror images
    double last_rounds = 0.4;    // of the rounds, with the vertices near the curves
    double half_way = 0.5;       // to the mirror image, which comes the other half
};
constexpr Tuning tuning;

// Where the chains through a junction want it.
struct Pull {
    Vec3 target = Vec3::Zero(); // sum of places, in barycentric coordinates of its face
    int count = 0;
};

Vec3 barycentric(const std::array<Vec2, 3>& c, const Vec2& p) {
    const auto cross = [](const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); };
    const double area = cross(c[1] - c[0], c[2] - c[0]);
    const double second = cross(p - c[0], c[2] - c[0]) / area;
    const double third = cross(c[1] - c[0], p - c[0]) / area;
    return {1.0 - second - third, second, third};
}

class Smoother {
public:
    Smoother(Network& network, const CurvedVertices& curved, const SmoothingAims& aims)
        : net_(network), scale_(aims.scale), rounds_(aims.rounds),
          chains_(make_chains(network, aims.scale)), anchors_(network, curved), alone_(aims.alone),
          plane_(aims.plane) {}

    void hold_near_vertices() { anchors_.add_near(net_); }

    void round(bool mirrored, const Progress& progress) {
        pulls_.assign(net_.nodes.size(), {});
        has_image_.assign(net_.nodes.size(), 0);
        image_.reset();
        if (mirrored && plane_)
            image_.emplace(net_, chain_of_curves(), *plane_, tuning.image * scale_,
                           tuning.image_spacing * scale_);
        for (const Chain& chain : chains_) {
            progress.check();
            move_chain(chain);
        }
        if (image_)
            pull_to_images();
        move_junctions();
    }

private:
    std::vector<Stop> stops_of(const Chain& chain) const;
    void add_stops(Index curve, bool forwards, std::vector<Stop>& stops) const;
    void move_chain(const Chain& chain);
    std::vector<Index> chain_of_curves() const;
    bool is_alone(const Chain& chain) const;
    void shift_to_image(Index chain, const std::vector<Stop>& stops, std::vector<FlatStop>& flat);
    void pull_to_images();
    void slide(const std::vector<Stop>& stops, const std::vector<FlatStop>& flat,
               const SmoothCurve& curve, std::size_t first, std::size_t end);
    void pass_vertices(const std::vector<Stop>& stops, const std::vector<double>& met, bool left,
                       std::size_t first, std::size_t end);
    void pull_junctions(const Chain& chain, const std::vector<Stop>& stops,
                        const std::vector<FlatStop>& flat, const SmoothCurve& curve,
                        std::size_t first, std::size_t end);
    void move_junctions();
    void move_junction(Index node, const Vec3& target);

    Network& net_;
    double scale_;
    int rounds_;
    std::vector<Chain> chains_;
    Anchors anchors_;
    const std::vector<std::uint8_t>& alone_;
    std::optional<mesh::MirrorPlane> plane_;
    std::optional<MirrorImage> image_; // of the curves as they were before the round
    std::vector<Pull> pulls_;
    std::vector<std::uint8_t> has_image_; // of each node: a curve that is drawn to one meets it
};

void Smoother::add_stops(Index number, bool forwards, std::vector<Stop>& stops) const {
    const Curve& curve = net_.curves[number];
    const Index last = net_.from_end(curve, !forwards);
    for (Index c = net_.from_end(curve, forwards); c >= 0; c = net_.after(c, forwards)) {
        stops.push_back({c, -1, forwards, net_.leaving(c, forwards)});
        if (c == last)
            break;
    }
}

std::vector<Stop> Smoother::stops_of(const Chain& chain) const {
    std::vector<Stop> stops;
    for (const auto& [curve, forwards] : chain.links) {
        const Index from = forwards ? net_.curves[curve].start : net_.curves[curve].end;
        if (from >= 0)
            stops.push_back({-1, from, forwards, {}});
        add_stops(curve, forwards, stops);
    }
    if (!chain.closed) {
        const auto& [curve, forwards] = chain.links.back();
        stops.push_back(
            {-1, forwards ? net_.curves[curve].end : net_.curves[curve].start, forwards, {}});
    }
    return stops;
}

void Smoother::move_chain(const Chain& chain) {
    std::vector<Stop> stops = stops_of(chain);
    std::size_t first = 0;
    std::size_t end = stops.size();
    if (chain.closed) {
        if (stops.size() < 3)
            return;
        // Unrolled until the ends are far enough from what is moved.
        const std::vector<Stop> once = stops;
        const double length = unfold(net_, once).back().along;
        const int turns =
            1 + static_cast<int>(std::min(4.0, tuning.margin * scale_ / std::max(length, 1e-12)));
        stops.clear();
        for (int k = 0; k <= 2 * turns; ++k)
            stops.insert(stops.end(), once.begin(), once.end());
        first = once.size() * static_cast<std::size_t>(turns);
        end = first + once.size();
    }
    if (stops.size() < 3)
        return;
    std::vector<FlatStop> flat = unfold(net_, stops);
    if (!(flat.back().along > 0.0))
        return;
    const std::vector<Hold> holds = anchors_.holds(net_, stops, flat);
    if (image_ && !is_alone(chain))
        shift_to_image(static_cast<Index>(&chain - chains_.data()), stops, flat);
    const SmoothCurve curve = smooth_curve(flat, holds, scale_, rounds_);
    pull_junctions(chain, stops, flat, curve, first, end);
    slide(stops, flat, curve, first, end);
}

// Of each curve; −1 where it stays on its edges.
std::vector<Index> Smoother::chain_of_curves() const {
    std::vector<Index> chain(net_.curves.size(), -1);
    for (std::size_t c = 0; c < chains_.size(); ++c)
        for (const auto& [curve, forwards] : chains_[c].links)
            chain[at(curve)] = static_cast<Index>(c);
    return chain;
}

bool Smoother::is_alone(const Chain& chain) const {
    return std::any_of(chain.links.begin(), chain.links.end(), [&](const auto& link) {
        return alone_[net_.curves[link.first].path.front()] != 0;
    });
}

// Half the way to the mirror image, across the curves: if all of them have one, since curves that
// are drawn in part get kinks.
void Smoother::shift_to_image(Index chain, const std::vector<Stop>& stops,
                              std::vector<FlatStop>& flat) {
    std::vector<Vec3> places;
    for (const Stop& stop : stops)
        places.push_back(stop.crossing >= 0 ? place_of_crossing(net_, stop.crossing)
                                            : place_of_node(net_, stop.node));
    std::vector<Vec2> shifts(stops.size(), Vec2::Zero());
    for (std::size_t i = 1; i + 1 < stops.size(); ++i) {
        const Vec3 along = (places[i + 1] - places[i - 1]).normalized();
        const Vec2 flat_along = (flat[i + 1].point - flat[i - 1].point).normalized();
        const std::optional<Vec3> way = image_->way(chain, places[i], along);
        if (!way)
            return;
        const Face f = stops[i].crossing >= 0                    ? face_of(stops[i].leaving)
                       : net_.nodes[stops[i].node].is_junction() ? net_.nodes[stops[i].node].face
                                                                 : Face();
        if (f < 0)
            continue;
        const double across = tuning.half_way * way->dot(net_.mesh.face_normals[f].cross(along));
        shifts[i] = across * Vec2(-flat_along.y(), flat_along.x());
    }
    for (std::size_t i = 0; i < flat.size(); ++i) {
        if (shifts[i].allFinite())
            flat[i].point += shifts[i];
        if (stops[i].node >= 0)
            has_image_[stops[i].node] = 1;
    }
}

// Junctions of curves that are drawn to their mirror images go half the way to their own.
void Smoother::pull_to_images() {
    for (Index n = 0; n < static_cast<Index>(net_.nodes.size()); ++n) {
        const Node& node = net_.nodes[n];
        if (!node.is_junction() || has_image_[n] == 0)
            continue;
        const std::optional<Vec3> way = image_->way_of_junction(place_of_node(net_, n));
        if (!way)
            continue;
        const Triangle& t = net_.mesh.faces[node.face];
        const Vec3& a = net_.mesh.points[t[0]];
        const Vec3 b = net_.mesh.points[t[1]] - a;
        const Vec3 c = net_.mesh.points[t[2]] - a;
        const Vec3& normal = net_.mesh.face_normals[node.face];
        const double twice = b.cross(c).dot(normal);
        const Vec3 step = tuning.half_way * *way;
        const double second = step.cross(c).dot(normal) / twice;
        const double third = b.cross(step).dot(normal) / twice;
        pulls_[n].target += node.weights + Vec3(-second - third, second, third);
        ++pulls_[n].count;
    }
}

void Smoother::slide(const std::vector<Stop>& stops, const std::vector<FlatStop>& flat,
                     const SmoothCurve& curve, std::size_t first, std::size_t end) {
    std::vector<double> met(stops.size(), 0.5);
    for (std::size_t i = first; i < end; ++i) {
        if (stops[i].crossing < 0)
            continue;
        const FlatStop& stop = flat[i];
        const std::optional<double> t = meet(curve, stop);
        const Vec2 edge = stop.left - stop.right;
        met[i] = t ? *t : (curve.place(stop.along) - stop.right).dot(edge) / edge.squaredNorm();
        if (!std::isfinite(met[i])) // an edge without length
            met[i] = net_.position(stops[i].crossing, stops[i].leaving);
        Crossing& crossing = net_.crossings[stops[i].crossing];
        const double kept = std::clamp(met[i], 1.0 - tuning.farthest_end, tuning.farthest_end);
        crossing.t = stops[i].forwards ? kept : 1.0 - kept;
    }
    for (std::size_t i = first; i < end; ++i)
        if (stops[i].crossing >= 0 && net_.has_company(stops[i].crossing))
            net_.keep_apart(stops[i].leaving, tuning.apart);
    for (const bool left : {true, false})
        pass_vertices(stops, met, left, first, end);
}

// A vertex is passed where the smooth curve meets the lines of its edges beyond it.
void Smoother::pass_vertices(const std::vector<Stop>& stops, const std::vector<double>& met,
                             bool left, std::size_t first, std::size_t end) {
    const auto vertex = [&](std::size_t i) {
        return left ? net_.mesh.target(stops[i].leaving) : net_.mesh.origin(stops[i].leaving);
    };
    const auto is_there = [&](std::size_t i) {
        return stops[i].crossing >= 0 && net_.crossings[stops[i].crossing].curve >= 0;
    };
    for (std::size_t i = first; i < end;) {
        if (!is_there(i)) {
            ++i;
            continue;
        }
        const Vertex w = vertex(i);
        std::size_t last = i;
        double beyond = 0.0; // sum over the edges: how far, as shares of them
        const auto weigh = [&](std::size_t k) { beyond += left ? met[k] - 1.0 : -met[k]; };
        weigh(i);
        while (last + 1 < end && is_there(last + 1) && vertex(last + 1) == w) {
            ++last;
            weigh(last);
        }
        if (beyond > 0.0) {
            // The run as the curve has it now, which another pass may have changed.
            Index a = stops[i].crossing;
            Index b = a;
            const bool side = left == stops[i].forwards;
            const auto goes_on = [&](Index c) { return c >= 0 && net_.beside(c, side) == w; };
            const Index start = a;
            while (goes_on(net_.crossings[a].previous) && net_.crossings[a].previous != start)
                a = net_.crossings[a].previous;
            while (goes_on(net_.crossings[b].next) && net_.crossings[b].next != a)
                b = net_.crossings[b].next;
            net_.pass(a, b, side);
        }
        i = last + 1;
    }
}

void Smoother::pull_junctions(const Chain& chain, const std::vector<Stop>& stops,
                              const std::vector<FlatStop>& flat, const SmoothCurve& curve,
                              std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i) {
        if (stops[i].node < 0 || !net_.nodes[stops[i].node].is_junction())
            continue;
        if (!chain.closed && (i == 0 || i + 1 == stops.size()))
            continue; // an end
        Pull& pull = pulls_[stops[i].node];
        pull.target += barycentric(flat[i].corners, curve.place(flat[i].along));
        ++pull.count;
    }
}

void Smoother::move_junctions() {
    for (Index node = 0; node < static_cast<Index>(net_.nodes.size()); ++node) {
        if (!net_.nodes[node].is_junction())
            continue;
        const Pull& pull = pulls_[node];
        if (pull.count > 0)
            move_junction(node, pull.target / pull.count);
        net_.keep_inside(node, tuning.inside);
    }
}

void Smoother::move_junction(Index number, const Vec3& target) {
    Node& node = net_.nodes[number];
    if (!target.allFinite())
        return;
    double share = 1.0; // of the way that lies in this face
    Index exit = -1;
    for (Index k = 0; k < 3; ++k)
        if (target[k] < 0.0) {
            const double s = node.weights[k] / (node.weights[k] - target[k]);
            if (s < share || exit < 0) {
                share = std::min(share, s);
                exit = k;
            }
        }
    if (exit < 0) {
        node.weights = target;
        return;
    }
    const Vec3 edge_point = node.weights + share * (target - node.weights);
    const HalfEdge e = half_edge_of(node.face, (exit + 1) % 3);
    const double a = std::max(0.0, edge_point[(exit + 1) % 3]);
    const double b = std::max(0.0, edge_point[(exit + 2) % 3]);
    const double t = a + b > 0.0 ? b / (a + b) : 0.5;
    if (!net_.push(number, e, t)) {
        node.weights = edge_point.cwiseMax(tuning.inside);
        node.weights /= node.weights.sum();
        return;
    }
    const HalfEdge back = net_.mesh.twin[e];
    node.weights[corner_of(back)] = t * (1.0 - tuning.inside);
    node.weights[corner_of(Mesh::next(back))] = (1.0 - t) * (1.0 - tuning.inside);
    node.weights[corner_of(Mesh::previous(back))] = tuning.inside;
}

} // namespace

void smooth(Network& network, const CurvedVertices& curved, const SmoothingAims& aims,
            Progress& progress) {
    Smoother smoother(network, curved, aims);
    const int last = static_cast<int>(tuning.last_rounds * aims.rounds);
    for (int k = 0; k < aims.rounds; ++k) {
        if (k == aims.rounds - last)
            smoother.hold_near_vertices();
        smoother.round(k >= aims.rounds - 2 * last, progress);
        progress.update(static_cast<double>(k + 1) / aims.rounds);
    }
}

} // namespace devseg::curves
