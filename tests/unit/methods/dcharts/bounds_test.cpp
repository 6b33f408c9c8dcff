// What every chart keeps, on any mesh: its bound of stretch, flat faces in one piece, nets of
// polyhedra that are exact.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include <Eigen/SVD>
#include <gtest/gtest.h>

#include "devseg/atlas/disks.h"
#include "devseg/flatten/flatten.h"
#include "devseg/judge/final_map.h"
#include "devseg/judge/roughness.h"
#include "devseg/mesh/flat_regions.h"
#include "devseg/methods/dcharts/developable_charts.h"
#include "devseg/methods/dcharts/draft.h"
#include "devseg/methods/dcharts/joins.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::dcharts {
namespace {

DevelopableCharts segment(const Mesh& mesh, int charts, double max_chart_l2_stretch = 1.02) {
    Progress progress;
    DevelopableChartsOptions options;
    options.charts_number = charts;
    options.max_chart_l2_stretch = max_chart_l2_stretch;
    return segment_developable_charts(mesh, options, progress);
}

Index count(const DevelopableCharts& charts) {
    return 1 + *std::max_element(charts.chart.begin(), charts.chart.end());
}

// L2 stretch of each chart as it is flattened.
std::vector<double> final_stretch(const Mesh& mesh, const DevelopableCharts& charts) {
    Progress progress;
    std::vector<double> l2;
    for (const judge::TrialMap& map : judge::final_maps(
             mesh, make_untried_draft(mesh, charts.chart).faces, charts.seam, progress))
        l2.push_back(std::sqrt(map.l2_squared));
    return l2;
}

double worst(const Mesh& mesh, const DevelopableCharts& charts) {
    const std::vector<double> l2 = final_stretch(mesh, charts);
    return *std::max_element(l2.begin(), l2.end());
}

mesh::RawMesh box(double x, double y, double z, const Vec3& at) {
    mesh::RawMesh raw = shapes::cube(1);
    Vec3 low = raw.points.front();
    Vec3 high = low;
    for (const Vec3& p : raw.points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    for (Vec3& p : raw.points)
        p = at + (p - low).cwiseQuotient(high - low).cwiseProduct(Vec3(x, y, z));
    return raw;
}

void add(const mesh::RawMesh& part, mesh::RawMesh& whole) {
    const Index base = static_cast<Index>(whole.points.size());
    whole.points.insert(whole.points.end(), part.points.begin(), part.points.end());
    for (const Triangle& t : part.faces)
        whole.faces.push_back({t[0] + base, t[1] + base, t[2] + base});
}

// A hand with four long fingers: one chart over a finger is stretched many times.
mesh::RawMesh hand() {
    mesh::RawMesh raw = shapes::sphere(4);
    for (Vec3& p : raw.points) {
        double reach = 0.0;
        for (int finger = 0; finger < 4; ++finger) {
            const double angle = 0.5 * finger - 0.75;
            const Vec3 direction(std::sin(angle), std::cos(angle), 0.0);
            reach += std::exp(-80.0 * (p.normalized() - direction).squaredNorm());
        }
        p *= 1.0 + 2.5 * reach;
    }
    return raw;
}

TEST(ChartBounds, EveryChartKeepsItsBoundWhateverTheNumber) {
    const Mesh mesh = checks::gated(hand());
    for (const int number : {1, 4, 12}) {
        const DevelopableCharts charts = segment(mesh, number);
        EXPECT_LE(worst(mesh, charts), 1.02);
        EXPECT_EQ(std::count(charts.standing.begin(), charts.standing.end(), Standing::above), 0);
    }
    EXPECT_GT(worst(mesh, segment(mesh, 1, 0.0)), 1.02) << "the shape needs no bound";
}

TEST(ChartBounds, ASmallerBoundIsKeptToo) {
    const Mesh mesh = checks::gated(hand());
    const DevelopableCharts loose = segment(mesh, 4);
    const DevelopableCharts tight = segment(mesh, 4, 1.004);
    EXPECT_LE(worst(mesh, tight), 1.004);
    EXPECT_GE(count(tight), count(loose));
}

// Of 99 % of each chart's area and of its faces, measured anew on LPFB maps of 'Charts: Flatten':
// the longest and the shortest line in each face, on the surface over in the plane.
std::pair<double, double> final_strain(const Mesh& mesh, const DevelopableCharts& charts) {
    Progress progress;
    const atlas::DiskCuts disks = atlas::cut_charts_to_disks(
        mesh, atlas::make_chart_map(mesh, charts.chart, charts.seam, false), progress);
    const flatten::FlattenResult result =
        flatten::flatten_charts(mesh, disks.charts, flatten::FlattenMethod::lpfb, progress);
    double most_of_it = 0.0;
    double worst = 0.0;
    for (const flatten::FlatChart& flat : result.flat) {
        std::vector<std::pair<double, double>> strains; // and areas
        double area = 0.0;
        for (const Face f : flat.surface.all_faces()) {
            const Triangle& t = flat.surface.faces[f];
            const Triangle& corners = mesh.faces[flat.surface.face[f]];
            Eigen::Matrix2d plane;
            plane << flat.uv[t[1]] - flat.uv[t[0]], flat.uv[t[2]] - flat.uv[t[0]];
            Eigen::Matrix<double, 3, 2> space;
            space << mesh.points[corners[1]] - mesh.points[corners[0]],
                mesh.points[corners[2]] - mesh.points[corners[0]];
            const Eigen::Vector2d lengths =
                Eigen::JacobiSVD<Eigen::MatrixXd>(space * plane.inverse()).singularValues();
            strains.emplace_back(std::max(lengths[0] - 1.0, 1.0 - lengths[1]),
                                 0.5 * space.col(0).cross(space.col(1)).norm());
            area += strains.back().second;
        }
        std::sort(strains.begin(), strains.end());
        worst = std::max(worst, strains.back().first);
        double above = 0.01 * area;
        while ((above -= strains.back().second) > 0.0)
            strains.pop_back();
        most_of_it = std::max(most_of_it, strains.back().first);
    }
    return {most_of_it, worst};
}

TEST(ChartBounds, EveryChartKeepsItsStrainWhateverTheNumber) {
    const Mesh mesh = checks::gated(hand());
    const auto [much, most] = final_strain(mesh, segment(mesh, 4));
    EXPECT_GT(much, 0.1) << "the shape needs no bound";
    for (const double bound : {0.1, 0.03}) {
        Progress progress;
        DevelopableChartsOptions options;
        options.charts_number = 4;
        options.max_strain = bound;
        const DevelopableCharts charts = segment_developable_charts(mesh, options, progress);
        const auto [most_of_it, worst] = final_strain(mesh, charts);
        EXPECT_LE(most_of_it, bound);
        EXPECT_LE(worst, 2.0 * bound);
        EXPECT_NEAR(charts.strain.worst, worst, 0.02 * bound);
        EXPECT_EQ(std::count(charts.standing.begin(), charts.standing.end(), Standing::kept),
                  mesh.face_count());
    }
}

TEST(ChartBounds, BoxesUnfoldExactlyOneChartEach) {
    mesh::RawMesh raw;
    for (int i = 0; i < 12; ++i)
        add(box(1.0, 2.0, 3.0, Vec3(2.0 * i, 0.0, 0.0)), raw);
    const Mesh mesh = checks::gated(raw);
    const DevelopableCharts charts = segment(mesh, 10);
    EXPECT_EQ(count(charts), 12);
    EXPECT_LE(worst(mesh, charts), 1.0 + 1e-6);
}

TEST(ChartBounds, APrismUnfoldsExactly) {
    const Mesh mesh = checks::gated(shapes::capped_cylinder(24, 3));
    const DevelopableCharts charts = segment(mesh, 3);
    EXPECT_LE(count(charts), 3);
    EXPECT_LE(worst(mesh, charts), 1.0 + 1e-6);
}

// Fewer charts are wanted than its exact net has: it stays exact, whatever lies beside it.
TEST(ChartBounds, APlateWithHandlesUnfoldsExactlyBesideABall) {
    const mesh::RawMesh plate = shapes::slab(shapes::mask_with_holes(4));
    for (const bool with_ball : {false, true}) {
        SCOPED_TRACE(with_ball);
        mesh::RawMesh raw = plate;
        if (with_ball)
            add(shapes::sphere(3), raw);
        const Mesh mesh = checks::gated(raw);
        const DevelopableCharts charts = segment(mesh, 1, 1.02);
        const std::vector<double> l2 = final_stretch(mesh, charts);
        for (std::size_t f = 0; f < plate.faces.size(); ++f)
            ASSERT_NEAR(l2[at(charts.chart[f])], 1.0, 1e-6);
    }
}

TEST(ChartBounds, NoBorderRunsThroughAFlatFace) {
    mesh::RawMesh raw;
    add(box(4.0, 1.0, 2.0, Vec3(0.0, 0.0, 0.0)), raw);
    const Mesh mesh = checks::gated(raw);
    const DevelopableCharts charts = segment(mesh, 4);
    const mesh::FaceComponents regions = mesh::flat_regions(mesh);
    EXPECT_EQ(regions.count, 6);
    std::map<Index, std::set<Index>> charts_of;
    for (const Face f : mesh.all_faces())
        charts_of[regions.label[f]].insert(charts.chart[f]);
    for (const auto& [region, labels] : charts_of)
        EXPECT_EQ(labels.size(), 1U) << region;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0 && regions.label[face_of(h)] == regions.label[mesh.across(h)]) {
            EXPECT_EQ(charts.seam[h], 0);
        }
}

// A block of an L: closing borders leaves rings, whose cuts go around flat faces as well.
TEST(ChartBounds, NoCutOfARingRunsThroughAFlatFace) {
    const mesh::RawMesh raw = shapes::slab({"##", "#."});
    const Mesh mesh = checks::gated(raw);
    const DevelopableCharts charts = segment(mesh, 1);
    Progress progress;
    const atlas::ChartMap disks =
        atlas::cut_charts_to_disks(
            mesh, atlas::make_chart_map(mesh, charts.chart, charts.seam, false), progress)
            .charts;
    const mesh::FaceComponents regions = mesh::flat_regions(mesh);
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0 && regions.label[face_of(h)] == regions.label[mesh.across(h)]) {
            EXPECT_EQ(disks.seam[h], 0);
        }
    EXPECT_LE(worst(mesh, charts), 1.0 + 1e-6);
}

TEST(ChartBounds, ANoisyCylinderStaysInFewCharts) {
    // Noise of 0.3 % of the size, a seventh of the edges.
    const mesh::RawMesh raw = shapes::with_noise(shapes::cylinder_tube(150, 80), 0.0085, 7);
    const Mesh mesh = checks::gated(raw);
    const DevelopableCharts charts = segment(mesh, 10);
    EXPECT_LE(count(charts), 2);
    EXPECT_EQ(std::count(charts.standing.begin(), charts.standing.end(), Standing::above), 0);
    EXPECT_GT(charts.roughness, 1e-4);
}

TEST(ChartBounds, CleanSurfacesAreNotRough) {
    for (const mesh::RawMesh& raw : {shapes::sphere(4), hand(), shapes::torus(64, 32)})
        EXPECT_LT(std::sqrt(1.0 + segment(checks::gated(raw), 8).roughness), 1.002);
}

TEST(FlatRegions, FacesOfOnePlaneAreOneRegion) {
    EXPECT_EQ(mesh::flat_regions(checks::gated(shapes::cube(1))).count, 6);
    EXPECT_EQ(mesh::flat_regions(checks::gated(shapes::grid(7, 5, 3.0, 2.0))).count, 1);
    const Mesh ball = checks::gated(shapes::sphere(3));
    EXPECT_EQ(mesh::flat_regions(ball).count, ball.face_count());
}

TEST(FlatRegions, TakeTheLabelOfMostOfTheirArea) {
    const Mesh mesh = checks::gated(shapes::cube(1));
    std::vector<Index> label(mesh.faces.size(), 0);
    label[0] = 1; // half of a side
    std::vector<Index> whole = label;
    mesh::keep_regions_whole(mesh, 0.01, whole);
    const mesh::FaceComponents regions = mesh::flat_regions(mesh);
    for (const Face f : mesh.all_faces())
        for (const Face g : mesh.all_faces())
            if (regions.label[f] == regions.label[g]) {
                EXPECT_EQ(whole[f], whole[g]);
            }
    std::vector<Index> small = label;
    mesh::keep_regions_whole(mesh, 0.5, small); // no side has half of the area
    EXPECT_EQ(small, label);
}

TEST(Joins, PartsOfBordersAreClosedWhereTheWholeIsNotFlat) {
    // Two halves of a cube: closed along their whole border they would be a cube again.
    const Mesh mesh = checks::gated(shapes::cube(1));
    std::vector<Index> side = mesh::flat_regions(mesh).label;
    Progress progress;
    MergeOptions options;
    options.chart = {1.0001, 1.1};
    options.least_neck = 0.0;
    options.keep_corners = true;
    Draft draft = make_draft(mesh, side, {}, 1.0001, progress);
    merge_charts(mesh, options, draft, progress);
    EXPECT_EQ(draft.charts_number(), 1);
    EXPECT_NEAR(draft.excess(), 0.0, 1e-9);
    const atlas::DiskCuts net = atlas::cut_charts_to_disks(
        mesh, atlas::make_chart_map(mesh, draft.chart, draft.seam, false), progress);
    const auto cuts = std::count(net.charts.seam.begin(), net.charts.seam.end(), 1) / 2;
    EXPECT_EQ(cuts, 7); // of the 12 edges a net folds 5

    options.parts_above = 6; // whole borders alone
    Draft whole = make_draft(mesh, side, {}, 1.0001, progress);
    merge_charts(mesh, options, whole, progress);
    EXPECT_GT(whole.charts_number(), 1);
}

TEST(Joins, StopAtTheNumberThatIsEnough) {
    const Mesh mesh = checks::gated(shapes::cube(1));
    Progress progress;
    MergeOptions options;
    options.chart = {1.0001, 1.1};
    options.keep_corners = true;
    options.enough_charts = 4;
    Draft draft = make_draft(mesh, mesh::flat_regions(mesh).label, {}, 1.0001, progress);
    merge_charts(mesh, options, draft, progress);
    EXPECT_EQ(draft.charts_number(), 4);
}

// Fewest first: what a looser bound allows is not less, and is used where it shortens seams.
TEST(AutomaticCharts, LooserBoundsGiveNoMoreChartsAndShorterSeams) {
    const Mesh mesh = checks::gated(shapes::torus(40, 20));
    Index charts = mesh.face_count();
    double seams = infinite;
    for (const double bound : {1.001, 1.005, 1.02, 1.05}) {
        DevelopableChartsOptions options;
        options.charts_number = 0;
        options.max_l2_stretch = bound;
        options.max_chart_l2_stretch = 0.0;
        Progress progress;
        const DevelopableCharts found = segment_developable_charts(mesh, options, progress);
        EXPECT_TRUE(found.bounds_kept);
        EXPECT_LE(found.l2_stretch, bound);
        EXPECT_LE(count(found), charts);
        double length = 0.0;
        for (const HalfEdge h : mesh.all_half_edges())
            if (mesh.twin[h] > h &&
                (found.seam[h] != 0 || found.chart[face_of(h)] != found.chart[mesh.across(h)]))
                length += mesh.edge_length(h);
        EXPECT_LT(length, seams);
        charts = count(found);
        seams = length;
    }
}

} // namespace
} // namespace devseg::dcharts
