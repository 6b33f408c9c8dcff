// How long the cuts to disks are, against shortest paths, closed forms and brute force.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "devseg/atlas/disks.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::atlas {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// How far above the shortest cuts the greedy construction may end.
constexpr double allowance = 1.3;

DiskCuts cut(const Mesh& mesh) {
    Progress progress;
    return cut_charts_to_disks(mesh, checks::components(mesh), {false, {}, HoleRule::none()},
                               progress);
}

// Lengths of the model, whatever the internal unit.
double cut_length(const mesh::RawMesh& raw) {
    const Mesh mesh = checks::gated(raw);
    return cut(mesh).cut_length * mesh.unit_length;
}

TEST(CutLength, AnAnnulusIsCutAlongTheShortestPathBetweenItsLoops) {
    for (std::uint32_t seed = 1; seed <= 10; ++seed) {
        const mesh::RawMesh raw = shapes::with_noise(shapes::annulus(16, 5, 1.0, 2.0), 0.08, seed);
        const Mesh mesh = checks::gated(raw);
        // Bellman and Ford from the outer loop to the inner one: vertices 0–15 and 80–95.
        std::vector<double> distance(mesh.points.size(), infinity);
        std::fill(distance.begin(), distance.begin() + 16, 0.0);
        for (std::size_t round = 0; round < mesh.points.size(); ++round)
            for (const HalfEdge h : mesh.all_half_edges())
                for (const auto& [a, b] :
                     {std::pair(mesh.origin(h), mesh.target(h)), {mesh.target(h), mesh.origin(h)}})
                    distance[b] = std::min(distance[b], distance[a] + mesh.edge_length(h));
        const double shortest = *std::min_element(distance.begin() + 80, distance.end());
        EXPECT_NEAR(cut(mesh).cut_length, shortest, 1e-12);
    }
}

TEST(CutLength, PlatesWithHolesAreCutAlongAShortestTree) {
    // Holes in a row with a frame of one cell: each is one cell away from the border.
    for (const Index holes : {1, 2, 3, 6})
        EXPECT_NEAR(cut_length(shapes::plate(shapes::mask_with_holes(holes))), holes, 1e-9);
}

TEST(CutLength, HolesNearEachOtherAreCutToEachOther) {
    // Three holes in a chain, one cell apart and three cells from the border.
    shapes::Mask mask(9, std::string(11, '#'));
    for (const std::size_t x : {3U, 5U, 7U})
        mask[4][x] = '.';
    EXPECT_LE(cut_length(shapes::plate(mask)), allowance * (3.0 + 1.0 + 1.0));
}

TEST(CutLength, CutsMayBranchOffFromOthers) {
    // All is mountains but a valley from the border, which forks to two holes.
    shapes::Mask mask(9, std::string(11, '#'));
    mask[4][2] = mask[4][8] = '.';
    mesh::RawMesh raw = shapes::plate(mask);
    for (Vec3& p : raw.points) {
        const bool border = p.x() < 0.5 || p.x() > 10.5 || p.y() < 0.5 || p.y() > 8.5;
        const bool hole = p.y() > 3.5 && p.y() < 5.5 &&
                          (std::abs(p.x() - 2.5) < 1.0 || std::abs(p.x() - 8.5) < 1.0);
        const bool stem = std::abs(p.x() - 5.0) < 0.5 && p.y() < 4.5;
        const bool arms = std::abs(p.y() - 4.0) < 0.5 && p.x() > 2.5 && p.x() < 8.5;
        if (!border && !hole && !stem && !arms)
            p.z() = 30.0;
    }
    EXPECT_NEAR(cut_length(raw), 4.0 + 2.0 + 3.0, 1e-9);
}

TEST(CutLength, ATubeIsCutAlongItsLength) {
    EXPECT_NEAR(cut_length(shapes::cylinder_tube(20, 5, 1.0, 3.0)), 3.0, 1e-9);
}

// The shortest cut graph of a torus of revolution, by brute force over its universal cover: two
// vertices that three arcs of independent classes join, or one vertex with two loops.
double shortest_cut(const Mesh& mesh, Index around, Index tube) {
    constexpr Index reach = 2; // turns to either side
    constexpr Index width = 2 * reach + 1;
    const Index sheets = width * width;
    const auto turns = [](Index from, Index to, Index count) {
        return to - from > count / 2 ? -1 : from - to > count / 2 ? 1 : 0;
    };
    double best = infinity;
    for (Index p = 0; p < tube; ++p) { // the others are turned copies
        std::vector<double> distance(at(mesh.vertex_count() * sheets), infinity);
        const auto node = [&](Index v, Index x, Index y) { return at(v * sheets + y * width + x); };
        std::set<std::tuple<double, Index, Index, Index>> queue{{0.0, p * around, reach, reach}};
        distance[node(p * around, reach, reach)] = 0.0;
        std::vector<std::vector<Index>> edges(at(mesh.vertex_count()));
        for (const HalfEdge h : mesh.all_half_edges())
            edges[mesh.origin(h)].push_back(h);
        while (!queue.empty()) {
            const auto [d, v, x, y] = *queue.begin();
            queue.erase(queue.begin());
            if (d > distance[node(v, x, y)])
                continue;
            for (const Index h : edges[v]) {
                const Index w = mesh.target(h);
                const Index nx = x + turns(v % around, w % around, around);
                const Index ny = y + turns(v / around, w / around, tube);
                if (nx < 0 || ny < 0 || nx >= width || ny >= width)
                    continue;
                const double through = d + mesh.edge_length(h);
                if (through < distance[node(w, nx, ny)]) {
                    distance[node(w, nx, ny)] = through;
                    queue.emplace(through, w, nx, ny);
                }
            }
        }
        for (const Vertex q : mesh.all_vertices())
            for (Index a = 0; a < sheets; ++a)
                for (Index b = a + 1; b < sheets; ++b)
                    for (Index c = b + 1; c < sheets; ++c) {
                        const Index area = (b % width - a % width) * (c / width - a / width) -
                                           (b / width - a / width) * (c % width - a % width);
                        if (std::abs(area) == 1)
                            best =
                                std::min(best, distance[q * sheets + a] + distance[q * sheets + b] +
                                                   distance[q * sheets + c]);
                    }
    }
    return best;
}

TEST(CutLength, ATorusIsCutNearlyAsShortAsCanBe) {
    for (const auto& [around, tube, large, small] : {std::tuple(24, 12, 2.0, 1.0),
                                                     {16, 16, 3.0, 1.0},
                                                     {20, 8, 5.0, 0.5},
                                                     {12, 20, 2.0, 1.5}}) {
        const Mesh mesh = checks::gated(shapes::torus(around, tube, large, small));
        const double shortest = shortest_cut(mesh, around, tube);
        const double found = cut(mesh).cut_length;
        EXPECT_GE(found, shortest - 1e-9);
        EXPECT_LE(found, allowance * shortest) << around << ' ' << tube;
    }
}

class UnionFind {
public:
    explicit UnionFind(Index count) : parent_(at(count)), sets(count) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    void join(Index a, Index b) {
        a = find(a);
        b = find(b);
        sets -= a != b ? 1 : 0;
        parent_[a] = b;
    }

private:
    Index find(Index i) const {
        while (parent_[i] != i)
            i = parent_[i];
        return i;
    }
    std::vector<Index> parent_;

public:
    Index sets;
};

// A graph on a torus cuts it to a disk when it is connected, has one edge more than vertices, and
// leaves the faces connected.
bool cuts_to_disk(const Mesh& mesh, const std::vector<Index>& edges, std::uint32_t chosen) {
    UnionFind vertices(mesh.vertex_count());
    UnionFind faces(mesh.face_count());
    std::uint32_t touched = 0;
    for (std::size_t e = 0; e < edges.size(); ++e)
        if ((chosen >> e & 1U) != 0) {
            touched |= 1U << mesh.origin(edges[e]) | 1U << mesh.target(edges[e]);
            vertices.join(mesh.origin(edges[e]), mesh.target(edges[e]));
        } else {
            faces.join(edges[e] / 3, mesh.twin[edges[e]] / 3);
        }
    const Index used = __builtin_popcount(touched);
    const Index parts = vertices.sets - (mesh.vertex_count() - used);
    return faces.sets == 1 && parts == 1 && __builtin_popcount(chosen) == used + 1;
}

TEST(CutLength, TheSmallestTorusIsCutNearlyAsShortAsCanBe) {
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
        // Seven vertices, each joined to all others.
        shapes::Random random(seed);
        mesh::RawMesh raw;
        for (Index i = 0; i < 7; ++i) {
            raw.points.push_back(random.direction());
            raw.faces.push_back({i, (i + 1) % 7, (i + 3) % 7});
            raw.faces.push_back({i, (i + 3) % 7, (i + 2) % 7});
        }
        const Mesh mesh = checks::gated(raw);
        std::vector<Index> edges;
        for (const HalfEdge h : mesh.all_half_edges())
            if (h < mesh.twin[h])
                edges.push_back(h);
        ASSERT_EQ(edges.size(), 21U);
        double shortest = infinity;
        for (std::uint32_t chosen = 0; chosen < 1U << 21U; ++chosen) {
            if (__builtin_popcount(chosen) > 8)
                continue; // seven vertices allow no more
            double length = 0.0;
            for (std::size_t e = 0; e < edges.size(); ++e)
                length += (chosen >> e & 1U) != 0 ? mesh.edge_length(edges[e]) : 0.0;
            if (length < shortest && cuts_to_disk(mesh, edges, chosen))
                shortest = length;
        }
        const double found = cut(mesh).cut_length;
        EXPECT_GE(found, shortest - 1e-12);
        EXPECT_LE(found, allowance * shortest) << "seed " << seed;
    }
}

// Length of what is left of the edges that a spanning tree of the faces does not cross, without
// dead ends: a cut to a disk, for any tree.
double length_of_cut(const Mesh& mesh, const std::vector<double>& weight) {
    std::vector<Index> order;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] > h)
            order.push_back(h);
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return weight[a] > weight[b]; });
    std::vector<Index> root(mesh.faces.size());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](Index f) {
        while (root[f] != f)
            f = root[f] = root[root[f]];
        return f;
    };
    std::vector<Index> cut;
    std::vector<Index> degree(mesh.points.size(), 0);
    for (const Index h : order) {
        const Index a = find(h / 3);
        const Index b = find(mesh.twin[h] / 3);
        if (a != b) {
            root[a] = b;
            continue;
        }
        cut.push_back(h);
        ++degree[mesh.origin(h)];
        ++degree[mesh.target(h)];
    }
    for (bool pruned = true; pruned;) {
        pruned = false;
        for (Index& h : cut)
            if (h >= 0 && (degree[mesh.origin(h)] == 1 || degree[mesh.target(h)] == 1)) {
                --degree[mesh.origin(h)];
                --degree[mesh.target(h)];
                h = -1;
                pruned = true;
            }
    }
    double length = 0.0;
    for (const Index h : cut)
        length += h >= 0 ? mesh.edge_length(h) : 0.0;
    return length;
}

// Many random trees, and from the best of them on, trees near it.
double shortest_by_search(const Mesh& mesh, int trials) {
    std::mt19937 random(7);
    const auto uniform = [&] { return std::ldexp(static_cast<double>(random()), -32); };
    std::vector<double> best(mesh.twin.size());
    double shortest = infinity;
    for (int trial = 0; trial < trials; ++trial) {
        std::vector<double> weight = best;
        const double change = trial < trials / 4 ? 1.0 : 0.02;
        for (const HalfEdge h : mesh.all_half_edges())
            if (trial < trials / 4 || uniform() < change)
                weight[h] = uniform() * mesh.edge_length(h);
        const double length = length_of_cut(mesh, weight);
        if (length <= shortest) {
            shortest = length;
            best = std::move(weight);
        }
    }
    return shortest;
}

TEST(CutLength, ADoubleTorusIsCutNearlyAsShortAsASearchFinds) {
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
        const Mesh mesh = checks::gated(shapes::with_noise(shapes::double_torus(), 0.1, seed));
        const double found = shortest_by_search(mesh, 40000);
        EXPECT_LE(cut(mesh).cut_length, allowance * found);
        EXPECT_LE(found, 3.0 * cut(mesh).cut_length); // the search is worth comparing with
    }
}

} // namespace
} // namespace devseg::atlas
