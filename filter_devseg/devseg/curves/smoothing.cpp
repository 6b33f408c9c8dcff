#include "devseg/curves/smoothing.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "devseg/curves/chains.h"
#include "devseg/curves/strip.h"

namespace devseg::curves {

namespace {

struct Tuning {
    double samples = 5.0;        // of the smooth curve, in one scale
    double stiffness = 0.5;      // scales: waves of 2 π of these shrink by a factor of e
    double farthest_end = 0.999; // of an edge: how near crossings come to its ends
    double margin = 6.0;         // scales: how far closed curves are smoothed beyond their ends
    double apart = 0.01;         // of an edge: how near curves come to each other on it
    double inside = 0.05;        // barycentric: how near junctions come to the edges of a face
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

// Solves (1 + b T²) y = x with T = tridiagonal(−1, 2, −1), in place; the ends have no curvature.
// By L D Lᵀ of a band of two.
void solve_bending(std::vector<Vec2>& x, double b) {
    const std::size_t n = x.size();
    std::vector<double> d(n);
    std::vector<double> l1(n, 0.0);
    std::vector<double> l2(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        const bool at_end = i == 0 || i + 1 == n;
        d[i] = 1.0 + (at_end ? 5.0 : 6.0) * b;
        if (i >= 2) {
            l2[i] = b / d[i - 2];
            d[i] -= l2[i] * l2[i] * d[i - 2];
            x[i] -= l2[i] * x[i - 2];
        }
        if (i >= 1) {
            const double other = i >= 2 ? l2[i] * d[i - 2] * l1[i - 1] : 0.0;
            l1[i] = (-4.0 * b - other) / d[i - 1];
            d[i] -= l1[i] * l1[i] * d[i - 1];
            x[i] -= l1[i] * x[i - 1];
        }
    }
    for (std::size_t i = n; i-- > 0;) {
        x[i] /= d[i];
        if (i + 1 < n)
            x[i] -= l1[i + 1] * x[i + 1];
        if (i + 2 < n)
            x[i] -= l2[i + 2] * x[i + 2];
    }
}

// A smooth curve in the plane of a strip, sampled at equal distances.
struct SmoothCurve {
    std::vector<Vec2> samples;
    double step = 1.0;

    Vec2 place(double along) const {
        const double k = std::clamp(along / step, 0.0, static_cast<double>(samples.size() - 1));
        const auto i = std::min(static_cast<std::size_t>(k), samples.size() - 2);
        const double s = k - static_cast<double>(i);
        return (1.0 - s) * samples[i] + s * samples[i + 1];
    }
};

SmoothCurve smooth_curve(const std::vector<FlatStop>& stops, double scale, int rounds) {
    SmoothCurve curve;
    const double length = stops.back().along;
    const auto pieces = std::max(2, static_cast<int>(std::ceil(tuning.samples * length / scale)));
    curve.step = length / pieces;
    std::size_t i = 0;
    for (int k = 0; k <= pieces; ++k) {
        const double along = curve.step * k;
        while (i + 2 < stops.size() && stops[i + 1].along < along)
            ++i;
        const double part = stops[i + 1].along - stops[i].along;
        const double s = part > 0.0 ? std::clamp((along - stops[i].along) / part, 0.0, 1.0) : 0.0;
        curve.samples.push_back((1.0 - s) * stops[i].point + s * stops[i + 1].point);
    }
    // Straight lines stay as they are, so the ends can be taken for zero.
    const Vec2 from = curve.samples.front();
    const Vec2 slope = (curve.samples.back() - from) / pieces;
    std::vector<Vec2> inner;
    for (int k = 1; k < pieces; ++k)
        inner.push_back(curve.samples[at(k)] - from - slope * k);
    const double units = scale / curve.step;
    solve_bending(inner, std::pow(tuning.stiffness * units, 4.0) / rounds);
    for (int k = 1; k < pieces; ++k)
        curve.samples[at(k)] = inner[at(k - 1)] + from + slope * k;
    return curve;
}

// Where the smooth curve meets the line of an edge, from its right end (0) to its left (1), nearest
// to where the curve met it before. None where it does not come near.
std::optional<double> meet(const SmoothCurve& curve, const FlatStop& stop) {
    const Vec2 edge = stop.left - stop.right;
    const double squared = edge.squaredNorm();
    const auto count = static_cast<std::ptrdiff_t>(curve.samples.size()) - 1;
    const auto middle = std::clamp<std::ptrdiff_t>(
        static_cast<std::ptrdiff_t>(stop.along / curve.step), 0, count - 1);
    const auto reach = static_cast<std::ptrdiff_t>(2.0 * std::sqrt(squared) / curve.step) + 2;
    const auto side = [&](std::ptrdiff_t k) {
        const Vec2 d = curve.samples[static_cast<std::size_t>(k)] - stop.right;
        return edge.x() * d.y() - edge.y() * d.x();
    };
    for (std::ptrdiff_t away = 0; away <= reach; ++away)
        for (const std::ptrdiff_t k : {middle - away, middle + away}) {
            if (k < 0 || k >= count)
                continue;
            const double a = side(k);
            const double b = side(k + 1);
            // From the left of the edge to its right, as the strip goes.
            if (!(a >= 0.0 && b < 0.0))
                continue;
            const double s = a / (a - b);
            const Vec2 p = (1.0 - s) * curve.samples[static_cast<std::size_t>(k)] +
                           s * curve.samples[static_cast<std::size_t>(k + 1)];
            return (p - stop.right).dot(edge) / squared;
        }
    return {};
}

class Smoother {
public:
    Smoother(Network& network, double scale, int rounds)
        : net_(network), scale_(scale), rounds_(rounds), chains_(make_chains(network, scale)) {}

    void round(const Progress& progress) {
        pulls_.assign(net_.nodes.size(), {});
        for (const Chain& chain : chains_) {
            progress.check();
            move_chain(chain);
        }
        move_junctions();
    }

private:
    std::vector<Stop> stops_of(const Chain& chain) const;
    void add_stops(Index curve, bool forwards, std::vector<Stop>& stops) const;
    void move_chain(const Chain& chain);
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
    std::vector<Pull> pulls_;
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
    const std::vector<FlatStop> flat = unfold(net_, stops);
    if (!(flat.back().along > 0.0))
        return;
    const SmoothCurve curve = smooth_curve(flat, scale_, rounds_);
    pull_junctions(chain, stops, flat, curve, first, end);
    slide(stops, flat, curve, first, end);
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

void smooth(Network& network, double scale, int rounds, Progress& progress) {
    Smoother smoother(network, scale, rounds);
    for (int k = 0; k < rounds; ++k) {
        smoother.round(progress);
        progress.update(static_cast<double>(k + 1) / rounds);
    }
}

} // namespace devseg::curves
