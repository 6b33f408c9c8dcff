#include "devseg/graph/shortest_paths.h"

#include <algorithm>
#include <utility>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "unit/mesh_edits.h"

namespace devseg::graph {
namespace {

using shapes::Random;

struct Edge {
    Index target;
    double length;
};
using Edges = std::vector<std::vector<Edge>>; // by the node that they leave

// Few lengths: many paths are equally long.
Edges random_edges(Index nodes, Index edges, Random& random) {
    Edges result(at(nodes));
    for (Index i = 0; i < edges; ++i) {
        const double length = static_cast<double>(random.below(4));
        result[at(random.below(nodes))].push_back({random.below(nodes), length});
    }
    return result;
}

// A grid of n × n nodes with edges of length 1.
Edges grid(Index n) {
    Edges edges(at(n * n));
    for (Index v = 0; v < n * n; ++v) {
        if (v % n > 0)
            edges[at(v)].push_back({v - 1, 1.0});
        if (v % n < n - 1)
            edges[at(v)].push_back({v + 1, 1.0});
        if (v >= n)
            edges[at(v)].push_back({v - n, 1.0});
        if (v < n * n - n)
            edges[at(v)].push_back({v + n, 1.0});
    }
    return edges;
}

void run(const Edges& edges, ShortestPaths<>& paths) {
    paths.run([&](Index v, double distance) {
        for (const Edge& e : edges[at(v)])
            paths.reach(e.target, distance + e.length, v);
    });
}

// Bellman and Ford: every edge, until nothing changes.
std::vector<double> reference(const Edges& edges, const std::vector<Index>& sources) {
    std::vector<double> distance(edges.size(), infinite);
    for (const Index v : sources)
        distance[at(v)] = 0.0;
    for (bool changes = true; changes;) {
        changes = false;
        for (std::size_t v = 0; v < edges.size(); ++v)
            for (const Edge& e : edges[v])
                if (distance[v] + e.length < distance[at(e.target)]) {
                    distance[at(e.target)] = distance[v] + e.length;
                    changes = true;
                }
    }
    return distance;
}

TEST(ShortestPaths, AreAsShortAsThoseOfBellmanAndFord) {
    for (std::uint32_t seed = 1; seed <= 50; ++seed) {
        Random random(seed);
        const Index nodes = 2 + random.below(60);
        const Edges edges = random_edges(nodes, random.below(4 * nodes), random);
        const std::vector<Index> sources{random.below(nodes), random.below(nodes)};
        ShortestPaths<> paths(edges.size());
        for (const Index v : sources)
            paths.add_source(v);
        run(edges, paths);
        EXPECT_EQ(paths.distance, reference(edges, sources));
    }
}

TEST(ShortestPaths, StepsLeadBackToASource) {
    Random random(3);
    const Edges edges = random_edges(50, 150, random);
    ShortestPaths<> paths(edges.size());
    paths.add_source(7);
    run(edges, paths);
    for (Index v = 0; v < 50; ++v) {
        if (v == 7 || paths.distance[at(v)] == infinite) {
            EXPECT_EQ(paths.step[at(v)], -1);
            continue;
        }
        Index u = v;
        for (int steps = 0; paths.step[at(u)] >= 0 && steps < 50; ++steps)
            u = paths.step[at(u)];
        EXPECT_EQ(u, 7);
    }
}

TEST(ShortestPaths, VisitEachNodeOnceByDistanceThenByNumber) {
    const Edges edges = grid(9);
    ShortestPaths<> paths(edges.size());
    paths.add_source(40);
    std::vector<std::pair<double, Index>> visits;
    paths.run([&](Index v, double distance) {
        visits.emplace_back(distance, v);
        for (const Edge& e : edges[at(v)])
            paths.reach(e.target, distance + e.length);
    });
    EXPECT_EQ(visits.size(), edges.size());
    EXPECT_TRUE(std::is_sorted(visits.begin(), visits.end()));
}

TEST(ShortestPaths, OfEqualPathsTheFirstOfferCounts) {
    const Edges edges = grid(3);
    ShortestPaths<> paths(edges.size());
    paths.add_source(0);
    run(edges, paths);
    EXPECT_EQ(paths.step[4], 1); // not 3, which comes later
    EXPECT_EQ(paths.step[8], 5);
}

TEST(ShortestPaths, StopAndGoOn) {
    const Edges edges = grid(6);
    ShortestPaths<> paths(edges.size());
    paths.add_source(0);
    Index visited = 0;
    paths.run([&](Index v, double distance) {
        for (const Edge& e : edges[at(v)])
            paths.reach(e.target, distance + e.length, v);
        return ++visited < 5;
    });
    EXPECT_EQ(visited, 5);
    EXPECT_EQ(paths.distance[35], infinite);
    run(edges, paths);
    EXPECT_EQ(paths.distance, reference(edges, {0}));
}

TEST(ShortestPaths, SourcesMayComeLater) {
    const Edges edges = grid(6);
    ShortestPaths<> paths(edges.size());
    paths.add_source(0);
    run(edges, paths);
    paths.add_source(35);
    run(edges, paths);
    EXPECT_EQ(paths.distance, reference(edges, {0, 35}));
    EXPECT_EQ(paths.step[35], -1);
}

TEST(ShortestPaths, ClearForgetsAll) {
    const Edges edges = grid(6);
    ShortestPaths<> paths(edges.size());
    paths.add_source(0);
    paths.run([](Index, double) { return false; });
    paths.clear();
    EXPECT_EQ(paths.distance, std::vector<double>(edges.size(), infinite));
    paths.add_source(21);
    run(edges, paths);
    EXPECT_EQ(paths.distance, reference(edges, {21}));
    EXPECT_EQ(paths.step[21], -1);
}

TEST(ShortestPaths, CanBeCancelled) {
    const Edges edges = grid(40);
    ShortestPaths<> paths(edges.size());
    paths.add_source(0);
    Progress stopped([](double, const char*) { return false; });
    EXPECT_THROW(stopped.update(0.0), Cancelled);
    const auto visit = [&](Index v, double distance) {
        for (const Edge& e : edges[at(v)])
            paths.reach(e.target, distance + e.length);
    };
    EXPECT_THROW(paths.run(visit, stopped), Cancelled);
}

} // namespace
} // namespace devseg::graph
