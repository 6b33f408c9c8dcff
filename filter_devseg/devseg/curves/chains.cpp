#include "devseg/curves/chains.h"

#include <array>
#include <cmath>

namespace devseg::curves {

namespace {

struct Tuning {
    double straight = 50.0; // degrees: curves that turn by less at a junction go on there
};
constexpr Tuning tuning;

// An end of a curve, with its direction away from the junction.
struct Leaf {
    Index curve;
    bool start;
    Vec3 direction;
};

// Where each end of a curve goes on: a curve, and whether it is its start; −1 for none.
using Ends = std::array<std::pair<Index, bool>, 2>;

// In space: all directions at a junction are compared with each other.
Vec3 direction(const Mesh& mesh, const Curve& curve, bool start, double scale) {
    const auto edge = [&](std::size_t i) {
        return start ? curve.path[i] : mesh.twin[curve.path[curve.path.size() - 1 - i]];
    };
    const Vec3& from = mesh.points[mesh.origin(edge(0))];
    Vec3 to = from;
    double along = 0.0;
    for (std::size_t i = 0; i < curve.path.size() && along < scale; ++i) {
        to = mesh.points[mesh.target(edge(i))];
        along += mesh.edge_length(edge(i));
    }
    return (to - from).normalized();
}

// The two that turn least go on, and again of those that are left.
void pair_up(std::vector<Leaf> here, std::vector<Ends>& on) {
    for (;;) {
        double best = -std::cos(tuning.straight * degrees);
        std::pair<std::size_t, std::size_t> pair{0, 0};
        for (std::size_t i = 0; i < here.size(); ++i)
            for (std::size_t j = i + 1; j < here.size(); ++j) {
                const double cosine = here[i].direction.dot(here[j].direction);
                if (cosine < best) {
                    best = cosine;
                    pair = {i, j};
                }
            }
        if (pair.second == 0)
            return;
        const Leaf a = here[pair.first];
        const Leaf b = here[pair.second];
        on[a.curve][a.start ? 0 : 1] = {b.curve, b.start};
        on[b.curve][b.start ? 0 : 1] = {a.curve, a.start};
        here.erase(here.begin() + static_cast<std::ptrdiff_t>(pair.second));
        here.erase(here.begin() + static_cast<std::ptrdiff_t>(pair.first));
    }
}

Chain follow(const std::vector<Ends>& on, Index curve, bool forwards,
             std::vector<std::uint8_t>& done) {
    Chain chain;
    while (done[curve] == 0) {
        done[curve] = 1;
        chain.links.emplace_back(curve, forwards);
        const auto [next, start] = on[curve][forwards ? 1 : 0];
        if (next < 0)
            return chain;
        curve = next;
        forwards = start;
    }
    chain.closed = true;
    return chain;
}

} // namespace

std::vector<Chain> make_chains(const Network& network, double scale) {
    const auto count = static_cast<Index>(network.curves.size());
    const auto moves = [&](const Curve& curve) { return !curve.held && curve.first >= 0; };
    std::vector<std::vector<Leaf>> leaves(network.nodes.size());
    for (Index c = 0; c < count; ++c) {
        const Curve& curve = network.curves[c];
        for (const bool start : {true, false})
            if (moves(curve) && !curve.is_closed())
                leaves[start ? curve.start : curve.end].push_back(
                    {c, start, direction(network.mesh, curve, start, scale)});
    }
    std::vector<Ends> on(network.curves.size(), Ends{std::pair{-1, true}, std::pair{-1, true}});
    for (std::size_t node = 0; node < leaves.size(); ++node)
        if (network.nodes[node].is_junction())
            pair_up(std::move(leaves[node]), on);
    std::vector<Chain> chains;
    std::vector<std::uint8_t> done(network.curves.size(), 0);
    for (const bool closed : {false, true}) // what has ends, then what goes round
        for (Index c = 0; c < count; ++c) {
            const Curve& curve = network.curves[c];
            if (!moves(curve) || done[c] != 0)
                continue;
            if (curve.is_closed()) {
                done[c] = 1;
                chains.push_back({{{c, true}}, true});
            } else if (closed || on[c][0].first < 0 || on[c][1].first < 0) {
                chains.push_back(follow(on, c, closed || on[c][0].first < 0, done));
            }
        }
    return chains;
}

} // namespace devseg::curves
