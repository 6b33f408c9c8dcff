#include "devseg/atlas/disks.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/metrics/segmentation.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::atlas {
namespace {

DiskCuts cut(const Mesh& mesh, const ChartMap& charts, const HoleRule& holes = {}) {
    Progress progress;
    return cut_charts_to_disks(mesh, charts, {false, {}, holes}, progress);
}

DiskCuts cut(const Mesh& mesh) {
    return cut(mesh, checks::components(mesh));
}

bool is_disk(const checks::Topology& t) {
    return t.euler == 1 && t.loops == 1;
}

void expect_cuts(const Mesh& mesh, const ChartMap& before, const DiskCuts& cuts, bool keeps_holes) {
    EXPECT_TRUE(checks::is_valid(mesh, cuts.charts));
    EXPECT_EQ(cuts.charts.chart, before.chart); // no chart falls apart
    EXPECT_EQ(cuts.charts.count, before.count);
    const std::vector<ChartSurface> surfaces = extract_charts(mesh, before);
    Index open = 0; // charts that have to be cut
    for (Index c = 0; c < before.count; ++c) {
        EXPECT_TRUE(checks::is_sound(mesh, cuts.charts, c));
        EXPECT_TRUE(keeps_holes || is_disk(checks::topology(mesh, cuts.charts, c)));
        const bool was_disk = is_disk(checks::topology(mesh, before, c));
        open += keeps_holes ? !checks::is_sound(mesh, before, c) : !was_disk;
        // A disk whose boundary has two edges only is lengthened.
        open += was_disk && surfaces[c].loops[0].size() < 3;
    }
    EXPECT_EQ(cuts.cut_charts, open);
    for (const ChartSurface& surface : extract_charts(mesh, cuts.charts)) {
        EXPECT_TRUE(is_sound(mesh, surface));
        EXPECT_GE(surface.loops.at(0).size(), 3U);
    }
    // Old seams stay, and the length is that of the new ones.
    double length = 0.0;
    for (const HalfEdge h : mesh.all_half_edges()) {
        ASSERT_GE(cuts.charts.seam[h], before.seam[h]);
        if (cuts.charts.seam[h] > before.seam[h])
            length += 0.5 * mesh.edge_length(h);
    }
    EXPECT_NEAR(cuts.cut_length, length, 1e-9 * (1.0 + length));
}

// With holes kept, and without.
void expect_disks(const Mesh& mesh, const ChartMap& charts) {
    expect_cuts(mesh, charts, cut(mesh, charts), true);
    expect_cuts(mesh, charts, cut(mesh, charts, HoleRule::none()), false);
}

TEST(CutToDisks, EveryShapeBecomesADisk) {
    std::vector<mesh::RawMesh> all = {shapes::torus(12, 8),
                                      shapes::double_torus(),
                                      shapes::annulus(12, 3, 1, 2),
                                      shapes::sphere(0),
                                      shapes::sphere(3),
                                      shapes::tetrahedron(),
                                      shapes::cube(3),
                                      shapes::cylinder_tube(10, 6),
                                      shapes::moebius_strip(24, 3),
                                      shapes::moebius_strip(9),
                                      shapes::plate_with_handle(),
                                      shapes::torus(3, 3),
                                      shapes::cylinder_tube(3, 1),
                                      shapes::capped_cylinder(8, 3)};
    for (const Index holes : {1, 2, 5, 9}) {
        all.push_back(shapes::plate(shapes::mask_with_holes(holes)));
        all.push_back(shapes::slab(shapes::mask_with_holes(holes)));
    }
    for (std::size_t i = 0; i < all.size(); ++i) {
        SCOPED_TRACE("shape " + std::to_string(i));
        for (const double noise : {0.0, 0.03}) {
            const Mesh mesh = checks::gated(shapes::with_noise(all[i], noise, 5));
            const ChartMap charts = checks::components(mesh);
            expect_disks(mesh, charts);
        }
    }
}

TEST(CutToDisks, HolesThatTouchAndNest) {
    for (const shapes::Mask& mask : std::vector<shapes::Mask>{
             {"#####", "#.#.#", "#####", "#.#.#", "#####"},
             {"####", "#..#", "#..#", "####"},
             {"#######", "#.....#", "#.###.#", "#.#.#.#", "#.###.#", "#.....#", "#######"},
             {"####", "#.##", "##.#", "####"}}) { // holes that share a corner
        for (const mesh::RawMesh& raw : {shapes::plate(mask), shapes::slab(mask)}) {
            const Mesh mesh = checks::gated(raw);
            const ChartMap charts = checks::components(mesh);
            expect_disks(mesh, charts);
        }
    }
}

TEST(CutToDisks, RandomChartsOnRandomSurfaces) {
    for (std::uint32_t seed = 1; seed <= 40; ++seed) {
        shapes::Random random(seed);
        shapes::Mask mask(6, std::string(9, '#'));
        for (std::string& row : mask)
            for (char& cell : row)
                cell = random.below(5) == 0 ? '.' : '#';
        const Mesh mesh = checks::gated(shapes::with_noise(
            seed % 2 == 0 ? shapes::slab(mask) : shapes::plate(mask), 0.1, seed));
        std::vector<Index> labels;
        for (const Vec3& centre : mesh.face_centers)
            labels.push_back(static_cast<Index>(std::floor(3.0 * centre.x() + centre.z())));
        const ChartMap charts = make_chart_map(mesh, labels, {}, false);
        SCOPED_TRACE("seed " + std::to_string(seed));
        expect_disks(mesh, charts);
    }
}

// A thin crooked finger on a torus; its tip is the first corner of the first face.
mesh::RawMesh torus_with_finger(std::uint32_t seed) {
    mesh::RawMesh mesh = shapes::torus(16, 10);
    shapes::Random random(seed);
    const Triangle base = mesh.faces.back();
    mesh.faces.pop_back();
    Triangle ring = base;
    for (int k = 1; k <= 40; ++k) {
        Triangle next{};
        for (std::size_t i = 0; i < 3; ++i) {
            next[i] = static_cast<Index>(mesh.points.size());
            mesh.points.push_back(mesh.points[base[i]] + 0.2 * k * Vec3(1.0, 0.3, 2.0) +
                                  0.1 * random.direction());
        }
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = (i + 1) % 3;
            mesh.faces.push_back({ring[i], ring[j], next[j]});
            mesh.faces.push_back({ring[i], next[j], next[i]});
        }
        ring = next;
    }
    mesh.faces.insert(mesh.faces.begin(), ring);
    return mesh;
}

TEST(CutToDisks, CutsThroughHandlesHaveNoLooseEnds) {
    for (std::uint32_t seed = 1; seed <= 10; ++seed)
        for (const mesh::RawMesh& raw :
             {torus_with_finger(seed), shapes::with_noise(shapes::double_torus(), 0.05, seed)}) {
            const Mesh mesh = checks::gated(raw);
            const ChartMap charts = checks::components(mesh);
            const DiskCuts cuts = cut(mesh, charts);
            expect_cuts(mesh, charts, cuts, true);
            std::vector<int> ends(mesh.points.size(), 0);
            for (const HalfEdge h : mesh.all_half_edges())
                ends[mesh.origin(h)] += cuts.charts.seam[h];
            EXPECT_EQ(std::count(ends.begin(), ends.end(), 1), 0);
        }
}

TEST(CutToDisks, FacesWithoutLengthDoNotStopIt) {
    mesh::RawMesh raw = shapes::torus(10, 6);
    for (Index i = 0; i < 12; ++i)
        raw.points[i] = raw.points[20]; // a region of edges without length
    const Mesh mesh = checks::gated(raw);
    const ChartMap charts = checks::components(mesh);
    expect_disks(mesh, charts);
}

TEST(CutToDisks, DisksAreUntouched) {
    for (const mesh::RawMesh& raw :
         {shapes::grid(5, 4), shapes::cone(12, 4), shapes::hemisphere(8, 4)}) {
        const Mesh mesh = checks::gated(raw);
        const DiskCuts cuts = cut(mesh);
        EXPECT_EQ(cuts.cut_charts, 0);
        EXPECT_EQ(cuts.cut_length, 0.0);
        EXPECT_EQ(cuts.charts.seam, std::vector<std::uint8_t>(mesh.twin.size(), 0));
    }
    // Twice is as good as once.
    const Mesh mesh = checks::gated(shapes::double_torus());
    const DiskCuts once = cut(mesh);
    const DiskCuts twice = cut(mesh, once.charts);
    EXPECT_EQ(twice.charts.seam, once.charts.seam);
    EXPECT_EQ(twice.cut_charts, 0);
}

TEST(CutToDisks, ASlitOfOneEdgeIsLengthened) {
    // Cut along a single edge, a sphere is a disk, but its boundary of two edges has no inside.
    const Mesh mesh = checks::gated(shapes::sphere(1));
    std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    seam[0] = seam[mesh.twin[0]] = 1;
    const ChartMap charts =
        make_chart_map(mesh, std::vector<Index>(mesh.faces.size(), 0), seam, false);
    ASSERT_TRUE(extract_charts(mesh, charts).at(0).is_disk());
    const DiskCuts cuts = cut(mesh, charts);
    const ChartSurface surface = extract_charts(mesh, cuts.charts).at(0);
    EXPECT_TRUE(surface.is_disk());
    EXPECT_EQ(surface.loops.at(0).size(), 4U);
    EXPECT_EQ(cuts.cut_charts, 1);
    EXPECT_NEAR(cuts.cut_length, mesh.edge_length(0), 0.3 * mesh.edge_length(0));
}

TEST(CutToDisks, TheLengthIsThatOfTheSeams) {
    const Mesh mesh = checks::gated(shapes::moved(shapes::double_torus(), 37.0, Vec3::Zero()));
    const DiskCuts cuts = cut(mesh);
    EXPECT_NEAR(cuts.cut_length * mesh.unit_length, metrics::seam_length(mesh, cuts.charts), 1e-9);
}

TEST(CutToDisks, Cancels) {
    const Mesh mesh = checks::gated(shapes::double_torus());
    Progress progress([](double, const char*) { return false; });
    EXPECT_THROW(cut_charts_to_disks(mesh, checks::components(mesh), progress), Cancelled);
}

} // namespace
} // namespace devseg::atlas
