// Holes that lie flat, and cuts that leave them alone.
#include "devseg/atlas/holes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include "devseg/atlas/border_path.h"
#include "devseg/atlas/disks.h"
#include "devseg/atlas/flat_cuts.h"
#include "devseg/atlas/slit_closing.h"
#include "devseg/graph/unions.h"
#include "devseg/mesh/angle_defects.h"
#include "devseg/mesh/flat_regions.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::atlas {
namespace {

using shapes::pi;

const shapes::Mask sheet{"############", "#..##..##..#", "############", "####.##..###",
                         "############"};

// The sheet rolled up, once around, or only so far that its sides do not meet.
mesh::RawMesh rolled(double turn) {
    mesh::RawMesh raw = shapes::plate(sheet);
    const double step = turn / 12.0;
    for (Vec3& p : raw.points) {
        // Exactly the same place at both ends of a full turn.
        const double angle = turn >= 2.0 * pi && p.x() > 11.5 ? 0.0 : step * p.x();
        p = Vec3(std::cos(angle), p.y(), -std::sin(angle)) / (2.0 * std::sin(0.5 * step));
        p.y() *= 2.0 * std::sin(0.5 * step);
    }
    return raw;
}

ChartSurface whole(const Mesh& mesh) {
    return extract_charts(mesh, checks::components(mesh)).at(0);
}

DiskCuts cut(const Mesh& mesh, const HoleRule& holes = {}) {
    Progress progress;
    return cut_charts_to_disks(mesh, checks::components(mesh), {false, {}, holes}, progress);
}

std::ptrdiff_t holes_of(const mesh::RawMesh& raw) {
    const Mesh mesh = checks::gated(raw);
    const std::vector<std::uint8_t> flat = flat_holes(mesh, whole(mesh));
    return std::count(flat.begin(), flat.end(), 1);
}

TEST(FlatHoles, AreThoseInPlates) {
    for (const Index holes : {1, 2, 5, 9}) {
        const Mesh mesh = checks::gated(shapes::plate(shapes::mask_with_holes(holes)));
        EXPECT_EQ(holes_of(shapes::plate(shapes::mask_with_holes(holes))), holes);
        EXPECT_TRUE(is_sound(mesh, whole(mesh)));
        EXPECT_TRUE(is_sound(mesh, whole(mesh), HoleRule::exact()));
        EXPECT_FALSE(is_sound(mesh, whole(mesh), HoleRule::none()));
        EXPECT_FALSE(whole(mesh).is_disk());
    }
    EXPECT_EQ(holes_of(shapes::annulus(40, 1, 0.9, 1.0)), 1);
    EXPECT_EQ(holes_of(shapes::grid(4, 4)), 0);
}

TEST(FlatHoles, AreThoseInSheetsThatAreRolledUp) {
    const Mesh mesh = checks::gated(rolled(2.0));
    EXPECT_TRUE(is_sound(mesh, whole(mesh), HoleRule::exact()));
    EXPECT_EQ(holes_of(rolled(2.0)), 5);
    // Of a tube with the same holes, the two rims are none.
    EXPECT_EQ(holes_of(rolled(2.0 * pi)), 5);
}

TEST(FlatHoles, AreNoneWhereTheSurfaceBendsAroundThem) {
    EXPECT_EQ(holes_of(shapes::cylinder_tube(16, 4)), 0);
    EXPECT_EQ(holes_of(shapes::frustum(16, 3, 2.0, 1.0, 0.5)), 0);
    EXPECT_EQ(holes_of(shapes::frustum(16, 3, 2.0, 1.0, 0.01)), 1); // nearly flat
    const Mesh nearly = checks::gated(shapes::frustum(16, 3, 2.0, 1.0, 0.01));
    EXPECT_FALSE(is_sound(nearly, whole(nearly), HoleRule::exact()));
}

// Around the ends of a slit there are full turns, whatever rounding makes of them.
TEST(FlatHoles, ASlitIsOne) {
    mesh::RawMesh raw = shapes::grid(7, 5);
    for (Vec3& p : raw.points)
        p = Eigen::AngleAxisd(1.1, Vec3(0.3, -0.8, 0.5).normalized()) * p;
    const Mesh mesh = checks::gated(raw);
    const std::vector<std::uint8_t> rim = mesh::boundary_vertices(mesh);
    int slits = 0;
    for (const HalfEdge h : mesh.all_half_edges()) {
        if (rim[mesh.origin(h)] != 0 || rim[mesh.target(h)] != 0)
            continue;
        std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
        seam[h] = seam[mesh.twin[h]] = 1;
        const ChartSurface cut_open = extract_surface(mesh, whole(mesh).face, seam);
        ASSERT_EQ(cut_open.loops.size(), 2U);
        EXPECT_TRUE(is_sound(mesh, cut_open, HoleRule::exact()));
        ++slits;
    }
    EXPECT_GT(slits, 20);
}

TEST(FlatHoles, ABoxWithTwoHolesHasNoRim) {
    mesh::RawMesh raw = shapes::cube(3);
    raw.faces.erase(std::remove_if(raw.faces.begin(), raw.faces.end(),
                                   [&](const Triangle& t) {
                                       Vec3 centre = Vec3::Zero();
                                       for (const Index v : t)
                                           centre += raw.points[v] / 3.0;
                                       return std::abs(centre.x() - 0.5) < 0.17 &&
                                              std::abs(centre.y() - 0.5) < 0.17;
                                   }),
                    raw.faces.end());
    const Mesh mesh = checks::gated(raw);
    ASSERT_EQ(whole(mesh).loops.size(), 2U);
    EXPECT_EQ(holes_of(raw), 0);
    EXPECT_TRUE(extract_charts(mesh, cut(mesh).charts).at(0).is_disk());
}

TEST(CutToDisks, LeavesFlatHolesAlone) {
    for (const mesh::RawMesh& raw : {shapes::plate(shapes::mask_with_holes(4)), rolled(2.0),
                                     shapes::annulus(24, 3, 1.0, 2.0)}) {
        const Mesh mesh = checks::gated(raw);
        const DiskCuts cuts = cut(mesh);
        EXPECT_EQ(cuts.cut_charts, 0);
        EXPECT_EQ(cuts.cut_length, 0.0);
        EXPECT_EQ(std::count(cuts.charts.seam.begin(), cuts.charts.seam.end(), 1), 0);
        EXPECT_TRUE(extract_charts(mesh, cut(mesh, HoleRule::none()).charts).at(0).is_disk());
    }
}

TEST(CutToDisks, OpensATubeAndKeepsItsHoles) {
    const Mesh mesh = checks::gated(rolled(2.0 * pi));
    ASSERT_EQ(whole(mesh).loops.size(), 7U);
    const DiskCuts cuts = cut(mesh);
    const ChartSurface open = extract_charts(mesh, cuts.charts).at(0);
    EXPECT_TRUE(is_sound(mesh, open, HoleRule::exact()));
    // One slit from rim to rim, through two holes, where nothing has to be cut.
    EXPECT_EQ(open.loops.size(), 4U);
    EXPECT_NEAR(cuts.cut_length * mesh.unit_length, 3.0, 1e-9);
    EXPECT_EQ(cuts.cut_charts, 1);
}

TEST(CutToDisks, ChartsWithHornsHaveNoHolesLeft) {
    // A plate with a horn in its middle and a hole beside it.
    shapes::Mask mask(21, std::string(21, '#'));
    mask[10][16] = '.';
    mesh::RawMesh raw = shapes::plate(mask);
    for (Vec3& p : raw.points) {
        const double distance = std::hypot(p.x() - 8.0, p.y() - 10.0);
        p.z() = 8.0 * std::max(0.0, 3.0 - distance);
    }
    const Mesh mesh = checks::gated(raw);
    Progress progress;
    const DiskCuts cuts = cut_charts_to_disks(mesh, checks::components(mesh), {}, progress);
    EXPECT_GT(cuts.cut_tips, 0);
    EXPECT_TRUE(extract_charts(mesh, cuts.charts).at(0).is_disk());
    EXPECT_EQ(extract_charts(mesh, cut(mesh).charts).at(0).loops.size(), 2U);
}

TEST(CutCost, CutsGoAroundFlatFaces) {
    // From the hole in the roof of a house to its rim: along the ridge, not over the slope.
    mesh::RawMesh raw = shapes::plate({"#########", "#########", "#########", "####.####"});
    raw = shapes::join(
        raw, shapes::moved(shapes::plate({"####.####", "#########", "#########", "#########"}), 1.0,
                           Vec3(0, 4, 0)));
    for (Vec3& p : raw.points)
        p.z() = -0.8 * std::abs(p.y() - 4.0);
    const Mesh mesh = checks::gated(raw);
    const DiskCuts cuts = cut(mesh, HoleRule::none());
    EXPECT_TRUE(extract_charts(mesh, cuts.charts).at(0).is_disk());
    for (const HalfEdge h : mesh.all_half_edges())
        if (cuts.charts.seam[h] != 0) {
            EXPECT_LT(mesh.face_normals[face_of(h)].dot(mesh.face_normals[mesh.across(h)]), 0.9);
        }
}

TEST(SlitsToHoles, AreClosedWhereTheHoleLiesFlat) {
    for (const bool is_flat : {true, false}) {
        mesh::RawMesh raw = shapes::plate(shapes::mask_with_holes(3));
        for (Vec3& p : raw.points) // a tent over the middle hole
            if (!is_flat && p.x() > 2.5 && p.x() < 4.5 && p.y() > 0.5 && p.y() < 2.5)
                p.z() = 0.7;
        const Mesh mesh = checks::gated(raw);
        ChartMap charts = cut(mesh, HoleRule::none()).charts;
        const std::vector<double> no_cost(mesh.points.size(), 0.0);
        const Index closed = close_slits_to_holes(mesh, no_cost, 0.0, charts);
        const ChartSurface surface = extract_charts(mesh, charts).at(0);
        EXPECT_TRUE(is_sound(mesh, surface));
        EXPECT_EQ(surface.loops.size(), is_flat ? 4U : 1U);
        EXPECT_EQ(closed, is_flat ? 3 : 0);
        EXPECT_TRUE(checks::is_valid(mesh, charts));
    }
}

TEST(SlitsToHoles, StayWhereTheVerticesCost) {
    const Mesh mesh = checks::gated(shapes::annulus(12, 3, 1.0, 2.0));
    ChartMap charts = cut(mesh, HoleRule::none()).charts;
    const ChartMap before = charts;
    const std::vector<double> cost(mesh.points.size(), 1.0);
    EXPECT_EQ(close_slits_to_holes(mesh, cost, 0.1, charts), 0);
    EXPECT_EQ(charts.seam, before.seam);
    EXPECT_EQ(close_slits_to_holes(mesh, cost, 10.0, charts), 3);
    EXPECT_EQ(extract_charts(mesh, charts).at(0).loops.size(), 2U);
}

// A box of quads, each cut along its diagonal, in one chart.
TEST(FlatFaces, CutsAreLedAroundThem) {
    const Mesh mesh = checks::gated(shapes::cube(1));
    ChartMap charts = checks::components(mesh);
    std::fill(charts.seam.begin(), charts.seam.end(), std::uint8_t{1});
    const auto is_flat = [&](HalfEdge h) { return cut_cost(mesh, h) > 2.0 * mesh.edge_length(h); };
    graph::Unions tree(mesh.faces.size()); // of faces, over folds first
    for (const bool flat : {false, true})
        for (const HalfEdge h : mesh.all_half_edges()) {
            const Index f = tree.find(face_of(h));
            const Index g = tree.find(mesh.across(h));
            if (f == g || is_flat(h) != flat)
                continue;
            tree.join(f, g);
            charts.seam[h] = charts.seam[mesh.twin[h]] = 0;
        }
    ASSERT_TRUE(checks::is_sound(mesh, charts, 0));
    const auto through_flat = [&] {
        Index count = 0;
        for (const HalfEdge h : mesh.all_half_edges())
            count += charts.seam[h] != 0 && is_flat(h) ? 1 : 0;
        return count;
    };
    ASSERT_GT(through_flat(), 0);
    Progress progress;
    lead_around_flat_faces(mesh, mesh::angle_defects(mesh), 1e-6, charts, progress);
    EXPECT_EQ(through_flat(), 0);
    EXPECT_TRUE(checks::is_sound(mesh, charts, 0));
    // All corners stay on cuts.
    const std::vector<Index> cuts = cut_edges_at_vertices(mesh, charts.seam);
    EXPECT_GT(*std::min_element(cuts.begin(), cuts.end()), 0);
}

TEST(FlatFaces, StayWholeInOneChart) {
    const Mesh mesh = checks::gated(shapes::cube(2));
    // Upper and lower half: four sides lie in both.
    std::vector<Index> label;
    for (const Vec3& centre : mesh.face_centers)
        label.push_back(centre.z() > mesh.face_centers.front().z() ? 1 : 0);
    const ChartMap halves = make_chart_map(mesh, label, {}, false);
    const ChartMap charts = keep_flat_faces_whole(mesh, halves);
    EXPECT_TRUE(checks::is_valid(mesh, charts));
    const mesh::FaceComponents regions = mesh::flat_regions(mesh);
    ASSERT_EQ(regions.count, 6);
    std::vector<std::set<Index>> found(6);
    for (const Face f : mesh.all_faces())
        found[regions.label[f]].insert(charts.chart[f]);
    for (const std::set<Index>& one : found)
        EXPECT_EQ(one.size(), 1U);
    const ChartMap same = keep_flat_faces_whole(mesh, charts);
    EXPECT_EQ(same.chart, charts.chart);
    EXPECT_EQ(same.seam, charts.seam);
}

TEST(FlatFaces, HaveRimsAroundWhatStandsInTheirHoles) {
    const Mesh mesh = checks::gated(shapes::slab(shapes::mask_with_holes(1)));
    const std::vector<std::uint8_t> rims = rims_of_flat_faces(mesh);
    Index edges = 0;
    for (const HalfEdge h : mesh.all_half_edges()) {
        EXPECT_EQ(rims[h], rims[mesh.twin[h]]);
        edges += mesh.twin[h] > h ? rims[h] : 0;
    }
    EXPECT_EQ(edges, 8); // a square above and one below
    const auto is_joined = [&](HalfEdge h) { return rims[h] == 0; };
    EXPECT_EQ(mesh::face_components(mesh, is_joined).count, 2);
}

TEST(FlatFaces, HaveNoRimsAroundNothing) {
    for (const mesh::RawMesh& raw : {shapes::plate(shapes::mask_with_holes(2)), shapes::cube(3)}) {
        const std::vector<std::uint8_t> rims = rims_of_flat_faces(checks::gated(raw));
        EXPECT_EQ(std::count(rims.begin(), rims.end(), 1), 0);
    }
}

// A pyramid so small that nobody sees it, in the middle of a plate.
TEST(FlatFaces, HaveNoRimsAroundWhatIsTooSmall) {
    for (const double width : {0.02, 0.5}) {
        mesh::RawMesh raw = shapes::grid(3, 3, 3.0, 3.0);
        for (Vec3& p : raw.points) // the inner square shrinks
            for (const int k : {0, 1}) {
                const double middle = p[k] - 1.5;
                if (std::abs(p.x() - 1.5) < 1.0 && std::abs(p.y() - 1.5) < 1.0 &&
                    std::abs(std::abs(middle) - 0.5) < 1e-9)
                    p[k] = 1.5 + std::copysign(0.5 * width, middle);
            }
        const Mesh flat = checks::gated(raw);
        mesh::RawMesh peaked;
        peaked.points = flat.points;
        const Index tip = flat.vertex_count();
        Vec3 middle = Vec3::Zero();
        for (const Vec3& p : flat.points)
            middle += p / static_cast<double>(flat.points.size());
        const double unit = (flat.points[1] - flat.points[0]).norm() / raw.points[1].norm();
        peaked.points.push_back(middle + Vec3(0.0, 0.0, unit * width));
        for (const Face f : flat.all_faces()) {
            const Triangle& t = flat.faces[f];
            if ((flat.face_centers[f] - middle).norm() > 0.5 * unit * width) {
                peaked.faces.push_back(t);
                continue;
            }
            for (const HalfEdge h : half_edges_of(f)) // not the diagonal
                if (flat.face_centers[flat.across(h)] != flat.face_centers[f] &&
                    (flat.face_centers[flat.across(h)] - middle).norm() > 0.5 * unit * width)
                    peaked.faces.push_back({flat.origin(h), flat.target(h), tip});
        }
        const std::vector<std::uint8_t> rims = rims_of_flat_faces(checks::gated(peaked));
        EXPECT_EQ(std::count(rims.begin(), rims.end(), 1), width < 0.1 ? 0 : 8);
    }
}

// Two rows of squares: the straight way to the border is not to be cut.
TEST(FlatFaces, PathsRatherGoAllTheWayRound) {
    const Mesh mesh = checks::gated(shapes::grid(40, 2, 40.0, 2.0));
    std::vector<Index> faces(mesh.faces.size());
    std::iota(faces.begin(), faces.end(), 0);
    const std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    std::vector<std::uint8_t> uncut(mesh.twin.size(), 1);
    const double middle = mesh.points[at(41 + 20)].y();
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.points[mesh.origin(h)].y() == middle && mesh.points[mesh.target(h)].y() == middle)
            uncut[h] = 0;
    EXPECT_EQ(path_to_border(mesh, faces, seam, Vertex(41 + 20)).size(), 1U);
    EXPECT_EQ(path_to_border(mesh, faces, seam, Vertex(41 + 20), uncut).size(), 20U);
    std::fill(uncut.begin(), uncut.end(), std::uint8_t{1});
    EXPECT_EQ(path_to_border(mesh, faces, seam, Vertex(41 + 20), uncut).size(), 1U);
}

} // namespace
} // namespace devseg::atlas
