#include "devseg/methods/growth/seeds.h"

#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::growth {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<Index> seeds_of(const Mesh& mesh, Index count, std::uint32_t random_seed = 0) {
    Progress progress;
    return farthest_point_seeds(mesh, count, random_seed, progress);
}

// All shortest paths over centroids, by Floyd and Warshall.
std::vector<std::vector<double>> all_distances(const Mesh& mesh) {
    const std::size_t count = mesh.faces.size();
    std::vector<std::vector<double>> d(count, std::vector<double>(count, infinity));
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0) {
            const std::size_t f = at(h / 3);
            const std::size_t g = at(mesh.twin[h] / 3);
            d[f][g] = (mesh.face_centers[f] - mesh.face_centers[g]).norm();
        }
    for (std::size_t f = 0; f < count; ++f)
        d[f][f] = 0.0;
    for (std::size_t k = 0; k < count; ++k)
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = 0; j < count; ++j)
                d[i][j] = std::min(d[i][j], d[i][k] + d[k][j]);
    return d;
}

TEST(Seeds, EachIsFarthestFromThoseBefore) {
    for (const mesh::RawMesh& raw :
         {shapes::sphere(1), shapes::torus(8, 6), shapes::plate_with_handle()}) {
        const Mesh mesh = checks::gated(shapes::with_noise(raw, 0.05, 2));
        const auto distances = all_distances(mesh);
        const std::vector<Index> seeds = seeds_of(mesh, 12);
        ASSERT_EQ(seeds.size(), 12U);
        for (std::size_t i = 1; i < seeds.size(); ++i) {
            const auto nearest = [&](std::size_t f) {
                double d = infinity;
                for (std::size_t j = 0; j < i; ++j)
                    d = std::min(d, distances[seeds[j]][f]);
                return d;
            };
            for (std::size_t f = 0; f < mesh.faces.size(); ++f)
                ASSERT_LE(nearest(f), nearest(at(seeds[i])) + 1e-12);
        }
    }
}

TEST(Seeds, AllFacesWhenAsManyAreAskedFor) {
    for (const mesh::RawMesh& raw : {shapes::grid(4, 3), shapes::tetrahedron(), shapes::cube(2)}) {
        const Mesh mesh = checks::gated(raw);
        for (const std::uint32_t random_seed : {0U, 9U}) {
            const std::vector<Index> seeds = seeds_of(mesh, mesh.face_count(), random_seed);
            const std::set<Index> distinct(seeds.begin(), seeds.end());
            EXPECT_EQ(static_cast<Index>(distinct.size()), mesh.face_count());
        }
    }
}

TEST(Seeds, FacesThatCoincideAreStillDistinct) {
    // Four equal faces beside a square: most centroids coincide.
    mesh::RawMesh raw;
    raw.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    for (int i = 0; i < 4; ++i) {
        const Index n = static_cast<Index>(raw.points.size());
        raw.points.insert(raw.points.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
        raw.faces.push_back({n, n + 1, n + 2});
    }
    raw.faces.push_back({0, 1, 3});
    raw.faces.push_back({0, 3, 2});
    const Mesh mesh = checks::gated(raw);
    ASSERT_EQ(mesh.face_count(), 6);
    const std::vector<Index> seeds = seeds_of(mesh, 6);
    EXPECT_EQ(std::set<Index>(seeds.begin(), seeds.end()).size(), 6U);
}

TEST(Seeds, EveryComponentGetsOneBeforeAnyGetsTwo) {
    mesh::RawMesh raw = shapes::grid(6, 6, 10.0, 10.0);
    for (int i = 0; i < 4; ++i)
        raw = shapes::join(raw, shapes::moved(shapes::tetrahedron(), 0.01, Vec3(i, 0, 20)));
    const Mesh mesh = checks::gated(raw);
    const atlas::ChartMap parts = checks::components(mesh);
    std::set<Index> reached;
    for (const Index seed : seeds_of(mesh, 5))
        reached.insert(parts.chart[seed]);
    EXPECT_EQ(reached.size(), 5U);
}

TEST(Seeds, TheStartDoesNotDependOnTheOrderOfFaces) {
    const mesh::RawMesh raw = shapes::with_noise(shapes::sphere(2), 0.1, 3);
    const Mesh mesh = checks::gated(raw);
    const std::vector<Index> seeds = seeds_of(mesh, 10);
    for (std::uint32_t seed = 1; seed < 5; ++seed) {
        const std::vector<Index> order = shapes::random_order(raw.faces.size(), seed);
        std::vector<Index> found = seeds_of(checks::gated(shapes::with_face_order(raw, order)), 10);
        for (Index& f : found)
            f = order[f];
        EXPECT_EQ(found, seeds);
    }
}

TEST(Seeds, ZeroStartsAtTheFaceFarthestFromTheCentre) {
    mesh::RawMesh raw = shapes::sphere(2);
    raw.points[100] *= 3.0; // a spike
    const Mesh mesh = checks::gated(raw);
    const Triangle& t = mesh.faces[seeds_of(mesh, 1).at(0)];
    EXPECT_TRUE(t[0] == 100 || t[1] == 100 || t[2] == 100);
}

TEST(Seeds, RandomSeedsGiveDifferentStartsAndTheSameOnesTwice) {
    const Mesh mesh = checks::gated(shapes::sphere(2));
    std::set<Index> starts;
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
        EXPECT_EQ(seeds_of(mesh, 6, seed), seeds_of(mesh, 6, seed));
        starts.insert(seeds_of(mesh, 1, seed).at(0));
    }
    EXPECT_GT(starts.size(), 10U);
}

// A component without seeds is infinitely far, all of it: no face may come first by its number.
TEST(Seeds, OfSeveralComponentsDoNotDependOnTheOrderOfFaces) {
    const mesh::RawMesh raw = shapes::with_noise(
        shapes::join(shapes::sphere(1), shapes::moved(shapes::torus(8, 6), 0.5, {5.0, 1.0, -2.0})),
        0.05, 3);
    const Mesh mesh = checks::gated(raw);
    const std::vector<Index> seeds = seeds_of(mesh, 7);
    for (const std::uint32_t order : {1U, 2U, 3U}) {
        const Mesh other = checks::gated(
            shapes::with_face_order(raw, shapes::random_order(raw.faces.size(), order)));
        const std::vector<Index> found = seeds_of(other, 7);
        for (std::size_t i = 0; i < seeds.size(); ++i)
            EXPECT_LE((other.face_centers[found[i]] - mesh.face_centers[seeds[i]]).norm(), 1e-12)
                << i;
    }
}

} // namespace
} // namespace devseg::growth
