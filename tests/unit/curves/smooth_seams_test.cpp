#include "devseg/curves/smooth_seams.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "devseg/atlas/disks.h"
#include "devseg/atlas/slit_closing.h"
#include "devseg/mesh/angle_defects.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::curves {
namespace {

using atlas::ChartMap;

SmoothSeams smoothed(const Mesh& mesh, const ChartMap& charts, const SmoothOptions& options = {}) {
    Progress progress;
    return smooth_seams(mesh, charts, options, progress);
}

double length_of_seams(const Mesh& mesh, const ChartMap& charts) {
    double length = 0.0;
    for (const HalfEdge h : mesh.all_half_edges())
        if (charts.seam[h] != 0)
            length += 0.5 * mesh.edge_length(h);
    return length;
}

double smallest_angle(const Mesh& mesh, Face f) {
    double least = pi;
    for (const HalfEdge h : half_edges_of(f)) {
        const Vec3 a = mesh.points[mesh.target(h)] - mesh.points[mesh.origin(h)];
        const Vec3 b = mesh.points[mesh.apex(h)] - mesh.points[mesh.origin(h)];
        least = std::min(least, std::atan2(a.cross(b).norm(), a.dot(b)));
    }
    return least;
}

// The same surface: parts fill their faces and lie in them, and no part is a needle.
void expect_same_surface(const Mesh& mesh, const mesh::Refinement& fine) {
    EXPECT_TRUE(checks::is_valid(fine.mesh));
    EXPECT_NEAR(fine.mesh.total_area, mesh.total_area, 1e-12 * mesh.total_area);
    for (std::size_t v = 0; v < mesh.points.size(); ++v)
        EXPECT_EQ(fine.mesh.points[v], mesh.points[v]);
    std::map<Index, double> area;
    std::set<Index> changed;
    for (const mesh::Refinement::Part& part : fine.parts) {
        changed.insert(part.face);
        area[part.source] += fine.mesh.face_areas[part.face];
        EXPECT_GT(fine.mesh.face_normals[part.face].dot(mesh.face_normals[part.source]), 0.999);
        EXPECT_GE(smallest_angle(fine.mesh, part.face),
                  std::min(2.0 * degrees, 0.9 * smallest_angle(mesh, part.source)) - 1e-9);
        for (Index k = 0; k < 3; ++k) {
            Vec3 place = Vec3::Zero();
            for (Index j = 0; j < 3; ++j)
                place += part.corners[at(k)][j] * mesh.points[mesh.faces[part.source][at(j)]];
            EXPECT_LT((place - fine.mesh.points[fine.mesh.faces[part.face][at(k)]]).norm(), 1e-12);
        }
    }
    for (const auto& [source, sum] : area)
        EXPECT_NEAR(sum, mesh.face_areas[source], 1e-9 * mesh.face_areas[source]);
    for (const Face f : mesh.all_faces())
        if (changed.count(f) == 0) {
            EXPECT_EQ(fine.mesh.faces[f], mesh.faces[f]);
        }
}

// The charts are what they were: their number, their topology, and their areas nearly so.
void expect_same_charts(const Mesh& mesh, const ChartMap& charts, const SmoothSeams& made) {
    ASSERT_EQ(made.charts.count, charts.count);
    EXPECT_TRUE(checks::is_valid(made.refinement.mesh, made.charts));
    for (Index c = 0; c < charts.count; ++c) {
        const checks::Topology before = checks::topology(mesh, charts, c);
        const checks::Topology after = checks::topology(made.refinement.mesh, made.charts, c);
        EXPECT_EQ(after.euler, before.euler) << "chart " << c;
        EXPECT_EQ(after.loops, before.loops) << "chart " << c;
    }
}

void expect_sound(const Mesh& mesh, const ChartMap& charts, const SmoothSeams& made) {
    expect_same_surface(mesh, made.refinement);
    expect_same_charts(mesh, charts, made);
    EXPECT_NEAR(made.old_length, length_of_seams(mesh, charts), 1e-12);
    EXPECT_NEAR(made.new_length, length_of_seams(made.refinement.mesh, made.charts), 1e-12);
}

// Charts around random faces, each face going to the nearest in steps from face to face.
ChartMap random_charts(const Mesh& mesh, Index count, std::uint32_t seed) {
    shapes::Random random(seed);
    std::vector<Index> label(mesh.faces.size(), -1);
    std::vector<Index> queue;
    for (Index c = 0; c < count; ++c) {
        const Index f = random.below(mesh.face_count());
        if (label[f] < 0)
            queue.push_back(f);
        label[f] = c;
    }
    for (std::size_t i = 0; i < queue.size(); ++i)
        for (const HalfEdge h : half_edges_of(queue[i])) {
            const Face g = mesh.across(h);
            if (g >= 0 && label[g] < 0) {
                label[g] = label[queue[i]];
                queue.push_back(g);
            }
        }
    for (Index& l : label)
        l = std::max(l, 0);
    return atlas::make_chart_map(mesh, label, {}, false);
}

ChartMap cut_to_disks(const Mesh& mesh, const ChartMap& charts) {
    Progress progress;
    return atlas::cut_charts_to_disks(mesh, charts, progress).charts;
}

TEST(SmoothSeams, KeepSurfaceAndTopologyOfAnyCharts) {
    const std::vector<mesh::RawMesh> all = {
        shapes::sphere(2),
        shapes::sphere(4),
        shapes::torus(30, 20),
        shapes::torus(7, 5),
        shapes::annulus(30, 6, 1, 2),
        shapes::plate_with_handle(),
        shapes::slab(shapes::mask_with_holes(3)),
        shapes::finger(12, 20, 0.5, 4),
        shapes::moebius_strip(40, 4),
        shapes::cylinder_tube(24, 16),
        shapes::hemisphere(20, 8),
        shapes::tetrahedron(),
    };
    for (std::size_t i = 0; i < all.size(); ++i)
        for (std::uint32_t seed = 0; seed < 6; ++seed) {
            SCOPED_TRACE("shape " + std::to_string(i) + ", seed " + std::to_string(seed));
            const Mesh mesh = checks::gated(shapes::with_noise(all[i], seed % 2 * 0.02, seed));
            const Index count =
                std::min<Index>(2 + 3 * static_cast<Index>(seed), mesh.face_count());
            ChartMap charts = random_charts(mesh, count, seed);
            if (seed % 3 != 0)
                charts = cut_to_disks(mesh, charts);
            SmoothOptions options;
            options.smoothness = seed < 3 ? 0.01 : 0.05;
            options.keep_creases = seed % 2 == 0 ? 30.0 : 180.0;
            expect_sound(mesh, charts, smoothed(mesh, charts, options));
        }
}

// A band around a tube whose border goes up and down between the rows: it becomes a circle.
TEST(SmoothSeams, AZigzagAroundATubeBecomesACircle) {
    const Mesh mesh = checks::gated(shapes::cylinder_tube(48, 48, 1.0, 4.0));
    std::vector<Index> label;
    const auto column = [](const Vec3& p) {
        return static_cast<int>(std::floor(24.0 * std::atan2(p.y(), p.x()) / pi));
    };
    for (const Vec3& p : mesh.face_centers)
        label.push_back(p.z() * mesh.unit_length < 0.085 * (((column(p) % 2) + 2) % 2) ? 0 : 1);
    const ChartMap charts = atlas::make_chart_map(mesh, label, {}, false);
    ASSERT_EQ(charts.count, 2);
    SmoothOptions options;
    options.smoothness = 0.05;
    const SmoothSeams made = smoothed(mesh, charts, options);
    expect_sound(mesh, charts, made);
    EXPECT_EQ(made.smooth_seams, 1);
    EXPECT_EQ(made.kept_seams, 0);
    const double circle = 2.0 * pi / mesh.unit_length;
    EXPECT_GT(made.old_length, 1.3 * circle);
    EXPECT_NEAR(made.new_length, circle, 0.004 * circle);
}

// The staircase across a plate becomes the straight line between its ends, which stay.
TEST(SmoothSeams, AStaircaseBecomesAStraightLine) {
    const Mesh mesh = checks::gated(shapes::grid(40, 40));
    std::vector<Index> label;
    for (const Vec3& p : mesh.face_centers)
        label.push_back(p.x() + 0.5 * p.y() < 0.0 ? 0 : 1);
    const ChartMap charts = atlas::make_chart_map(mesh, label, {}, false);
    SmoothOptions options;
    options.smoothness = 0.05;
    const SmoothSeams made = smoothed(mesh, charts, options);
    expect_sound(mesh, charts, made);
    double farthest = 0.0;
    std::vector<Vec3> ends;
    const Mesh& fine = made.refinement.mesh;
    for (const HalfEdge h : fine.all_half_edges()) {
        if (made.charts.seam[h] == 0)
            continue;
        const Vec3& p = fine.points[fine.origin(h)];
        if (std::abs(std::abs(p.y()) * mesh.unit_length - 0.5) < 1e-9)
            ends.push_back(p);
        else
            farthest = std::max(farthest, std::abs(p.x() + 0.5 * p.y()) * mesh.unit_length);
    }
    ASSERT_EQ(ends.size(), 2U);
    EXPECT_LT(farthest, 0.025); // one square
    EXPECT_NEAR(made.new_length, (ends[0] - ends[1]).norm(), 0.003 * made.new_length);
}

TEST(SmoothSeams, OnCreasesStayWhereTheyAre) {
    const Mesh mesh = checks::gated(shapes::cube(12));
    std::vector<Index> label;
    for (const Vec3& n : mesh.face_normals) {
        Index axis = 0;
        n.cwiseAbs().maxCoeff(&axis);
        label.push_back(2 * axis + (n[axis] > 0.0 ? 1 : 0));
    }
    const ChartMap charts = atlas::make_chart_map(mesh, label, {}, false);
    ASSERT_EQ(charts.count, 6);
    const SmoothSeams made = smoothed(mesh, charts);
    EXPECT_TRUE(made.refinement.parts.empty());
    EXPECT_EQ(made.kept_seams, 12);
    EXPECT_EQ(made.smooth_seams, 0);
    EXPECT_EQ(made.charts.chart, charts.chart);
    EXPECT_EQ(made.charts.seam, charts.seam);

    SmoothOptions all;
    all.keep_creases = 180.0;
    EXPECT_GT(smoothed(mesh, charts, all).smooth_seams, 0);
}

TEST(SmoothSeams, SlitsKeepTheirTips) {
    const Mesh mesh = checks::gated(shapes::grid(30, 30));
    std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    std::set<Index> tips;
    for (const HalfEdge h : mesh.all_half_edges()) {
        // A staircase inside of the plate: steps right and up, by turns.
        const Vec3 a = mesh.points[mesh.origin(h)] * mesh.unit_length * 30.0;
        const Vec3 b = mesh.points[mesh.target(h)] * mesh.unit_length * 30.0;
        const auto on_stairs = [](const Vec3& p) {
            const double steps = std::round(p.x() + p.y());
            return std::abs(p.x() - p.y() - (std::abs(std::fmod(steps, 2.0)) > 0.5 ? 1.0 : 0.0)) <
                       0.1 &&
                   std::abs(p.x()) < 6.5;
        };
        if (mesh.twin[h] >= 0 && on_stairs(a) && on_stairs(b) && (a - b).norm() < 1.1)
            seam[h] = 1;
    }
    std::map<Index, int> degree;
    for (const HalfEdge h : mesh.all_half_edges())
        degree[mesh.origin(h)] += seam[h];
    for (const auto& [v, count] : degree)
        if (count == 1)
            tips.insert(v);
    ASSERT_EQ(tips.size(), 2U);
    const std::vector<Index> label(mesh.faces.size(), 0);
    const ChartMap charts = atlas::make_chart_map(mesh, label, seam, false);
    SmoothOptions options;
    options.smoothness = 0.05;
    const SmoothSeams made = smoothed(mesh, charts, options);
    expect_sound(mesh, charts, made);
    const double straight = (mesh.points[*tips.begin()] - mesh.points[*tips.rbegin()]).norm();
    EXPECT_GT(made.old_length, 1.3 * straight);
    EXPECT_NEAR(made.new_length, straight, 0.01 * straight);
    std::map<Index, int> fine_degree;
    for (const HalfEdge h : made.refinement.mesh.all_half_edges())
        fine_degree[made.refinement.mesh.origin(h)] += made.charts.seam[h];
    for (const Index tip : tips)
        EXPECT_EQ(fine_degree[tip], 1);
}

// Two charts whose border on a grid is a staircase.
std::vector<Index> sides_of_stairs(const Mesh& flat) {
    std::vector<Index> label;
    for (const Vec3& p : flat.face_centers)
        label.push_back(p.x() + 0.5 * p.y() < 0.0 ? 0 : 1);
    return label;
}

// A seam along the ridge of a plate takes up the curvature of its peak: it stays there.
TEST(SmoothSeams, GoThroughVerticesThatAreCurved) {
    mesh::RawMesh plate = shapes::grid(40, 40);
    const Mesh flat = checks::gated(plate);
    const std::vector<Index> label = sides_of_stairs(flat);
    const std::vector<std::uint8_t> seam = atlas::make_chart_map(flat, label, {}, false).seam;
    Vertex peak;
    for (const HalfEdge h : flat.all_half_edges())
        if (seam[h] != 0 &&
            (peak < 0 || flat.points[flat.origin(h)].norm() < flat.points[peak].norm()))
            peak = flat.origin(h);
    plate.points[peak].z() = 0.02;
    const Mesh mesh = checks::gated(plate);
    ASSERT_EQ(mesh.faces, flat.faces);
    const ChartMap charts = atlas::make_chart_map(mesh, label, {}, false);
    const auto passes_peak = [&](const Mesh& surface, const ChartMap& map) {
        bool found = false;
        for (const HalfEdge h : surface.all_half_edges())
            found = found || (map.seam[h] != 0 && surface.origin(h) == peak);
        return found;
    };
    ASSERT_TRUE(passes_peak(mesh, charts));
    SmoothOptions options;
    options.smoothness = 0.05;
    options.keep_creases = 180.0;
    const SmoothSeams made = smoothed(mesh, charts, options);
    expect_sound(mesh, charts, made);
    EXPECT_EQ(made.smooth_seams, 1);
    EXPECT_TRUE(passes_peak(made.refinement.mesh, made.charts));
    EXPECT_LT(made.new_length, 0.9 * made.old_length);
}

// The firmer a seam, the less curved are the vertices that it goes through.
TEST(SmoothSeams, FirmSeamsGoThroughLessCurvedVertices) {
    mesh::RawMesh plate = shapes::grid(40, 40);
    const Mesh flat = checks::gated(plate);
    const std::vector<Index> label = sides_of_stairs(flat);
    const std::vector<std::uint8_t> seam = atlas::make_chart_map(flat, label, {}, false).seam;
    Vertex top; // of the stairs that the seam makes
    for (const HalfEdge h : flat.all_half_edges())
        if (seam[h] != 0 && flat.points[flat.origin(h)].norm() < 0.1 &&
            (top < 0 || flat.points[flat.origin(h)].x() + 0.5 * flat.points[flat.origin(h)].y() >
                            flat.points[top].x() + 0.5 * flat.points[top].y()))
            top = flat.origin(h);
    ASSERT_GE(top, 0);
    const auto passes = [&](double curvature, Firmness firmness) {
        Mesh mesh = flat;
        for (double height = 0.0;; height += 5e-5) {
            plate.points[top].z() = height;
            mesh = checks::gated(plate);
            if (std::abs(mesh::angle_defects(mesh)[top]) > curvature * degrees)
                break;
        }
        SmoothOptions options;
        options.smoothness = 0.05;
        options.keep_creases = 180.0;
        Progress progress;
        const ChartMap charts = atlas::make_chart_map(mesh, label, {}, false);
        const SmoothSeams made = smooth_seams(mesh, charts, options, std::nullopt, progress,
                                              std::vector<Firmness>(mesh.twin.size(), firmness));
        expect_sound(mesh, charts, made);
        return atlas::cut_edges_at_vertices(made.refinement.mesh, made.charts.seam)[top] == 2;
    };
    for (const double curvature : {5.0, 12.0, 45.0}) {
        EXPECT_EQ(passes(curvature, Firmness::free), curvature > 40.0) << curvature;
        EXPECT_EQ(passes(curvature, Firmness::near), curvature > 10.0) << curvature;
        EXPECT_TRUE(passes(curvature, Firmness::nearer)) << curvature;
        EXPECT_TRUE(passes(curvature, Firmness::held)) << curvature;
    }
}

// Three seams that meet at a peak take up its curvature: their junction stays.
TEST(SmoothSeams, JunctionsStayAtVerticesThatAreCurved) {
    mesh::RawMesh plate = shapes::grid(40, 40);
    const Mesh flat = checks::gated(plate);
    const auto middle =
        std::min_element(flat.points.begin(), flat.points.end(), [](const Vec3& a, const Vec3& b) {
            return a.squaredNorm() < b.squaredNorm();
        });
    const Vertex peak(static_cast<Index>(middle - flat.points.begin()));
    std::vector<Index> label;
    for (const Vec3& p : flat.face_centers) {
        const double angle = std::atan2(p.y() - middle->y(), p.x() - middle->x());
        label.push_back(angle < -2.0 || angle > 2.5 ? 0 : angle < 0.3 ? 1 : 2);
    }
    const auto stays = [&](double height) {
        plate.points[peak].z() = height;
        const Mesh mesh = checks::gated(plate);
        const ChartMap charts = atlas::make_chart_map(mesh, label, {}, false);
        EXPECT_EQ(atlas::cut_edges_at_vertices(mesh, charts.seam)[peak], 3);
        SmoothOptions options;
        options.smoothness = 0.05;
        options.keep_creases = 180.0;
        const SmoothSeams made = smoothed(mesh, charts, options);
        expect_sound(mesh, charts, made);
        return atlas::cut_edges_at_vertices(made.refinement.mesh, made.charts.seam)[peak] == 3;
    };
    EXPECT_TRUE(stays(0.03));
    EXPECT_FALSE(stays(0.0));
}

// An egg whose triangles know nothing of its mirror plane, with a cap on each side.
mesh::RawMesh egg() {
    mesh::RawMesh mesh = shapes::sphere(4);
    const Eigen::AngleAxisd turn(0.7, Vec3(1.0, 2.0, 3.0).normalized());
    for (Vec3& p : mesh.points) {
        const Vec3 q = turn * p;
        p = {1.5 * q.x(), q.y() * (1.0 + 0.2 * q.y()), 0.8 * q.z() * (1.0 + 0.3 * q.y())};
    }
    return mesh;
}

double farthest_from_image(const SmoothSeams& made) {
    const Mesh& fine = made.refinement.mesh;
    std::vector<Vec3> places;
    for (const HalfEdge h : fine.all_half_edges())
        if (made.charts.seam[h] != 0)
            for (int k = 0; k < 8; ++k)
                places.push_back(fine.points[fine.origin(h)] +
                                 k / 8.0 *
                                     (fine.points[fine.target(h)] - fine.points[fine.origin(h)]));
    double low = infinite;
    double high = -infinite;
    for (const Vec3& p : fine.points) {
        low = std::min(low, p.x());
        high = std::max(high, p.x());
    }
    double farthest = 0.0;
    for (const Vec3& p : places) {
        const Vec3 image(low + high - p.x(), p.y(), p.z());
        double nearest = infinite;
        for (const Vec3& q : places)
            nearest = std::min(nearest, (q - image).norm());
        farthest = std::max(farthest, nearest);
    }
    return farthest;
}

TEST(SmoothSeams, MirrorEachOtherWhateverTheTriangles) {
    const Mesh mesh = checks::gated(egg());
    std::vector<Index> label;
    for (const Vec3& p : mesh.face_centers) {
        const double x = p.x() * mesh.unit_length;
        const double edge = 0.75 + 0.1 * std::sin(5.0 * std::atan2(p.z(), p.y()));
        label.push_back(x > edge ? 2 : x < -edge ? 1 : 0);
    }
    const ChartMap charts = atlas::make_chart_map(mesh, label, {}, false);
    ASSERT_EQ(charts.count, 3);
    SmoothOptions options;
    options.symmetric = true;
    const SmoothSeams made = smoothed(mesh, charts, options);
    expect_sound(mesh, charts, made);
    EXPECT_EQ(made.smooth_seams, 2);
    const double edge = mesh.edge_length(HalfEdge(0));
    EXPECT_LT(farthest_from_image(made), 0.25 * edge);
    EXPECT_GT(farthest_from_image(smoothed(mesh, charts)), 0.5 * edge);
}

// Two seams beside each other on one side, and one on the other: it is the image of one of them.
TEST(SmoothSeams, OnlyTheNearestIsDrawnToAnImage) {
    const Mesh mesh = checks::gated(egg());
    const double edge = mesh.edge_length(HalfEdge(0)) * mesh.unit_length;
    std::vector<Index> label;
    for (const Vec3& p : mesh.face_centers) {
        const double x = p.x() * mesh.unit_length;
        label.push_back(x > 0.75 ? 0 : x > -0.75 ? 1 : x > -0.75 - 1.6 * edge ? 2 : 3);
    }
    const ChartMap charts = atlas::make_chart_map(mesh, label, {}, false);
    ASSERT_EQ(charts.count, 4);
    SmoothOptions options;
    options.symmetric = true;
    const SmoothSeams made = smoothed(mesh, charts, options);
    expect_sound(mesh, charts, made);
    EXPECT_EQ(made.smooth_seams, 3);
    EXPECT_NEAR(made.new_length, smoothed(mesh, charts).new_length, 0.02 * made.new_length);
}

TEST(SmoothSeams, WithoutSeamsNothingChanges) {
    const Mesh mesh = checks::gated(shapes::sphere(2));
    const ChartMap charts = checks::components(mesh);
    const SmoothSeams made = smoothed(mesh, charts);
    EXPECT_TRUE(made.refinement.parts.empty());
    EXPECT_EQ(made.refinement.mesh.faces, mesh.faces);
    EXPECT_EQ(made.charts.chart, charts.chart);
    EXPECT_EQ(made.smooth_seams + made.kept_seams, 0);
}

TEST(SmoothSeams, AreTheSameInEveryRun) {
    const Mesh mesh = checks::gated(shapes::with_noise(shapes::sphere(4), 0.01, 3));
    const ChartMap charts = random_charts(mesh, 12, 1);
    const SmoothSeams one = smoothed(mesh, charts);
    const SmoothSeams two = smoothed(mesh, charts);
    EXPECT_EQ(one.refinement.mesh.points, two.refinement.mesh.points);
    EXPECT_EQ(one.refinement.mesh.faces, two.refinement.mesh.faces);
    EXPECT_EQ(one.charts.chart, two.charts.chart);
    EXPECT_EQ(one.charts.seam, two.charts.seam);
}

TEST(SmoothSeams, CanBeCancelled) {
    const Mesh mesh = checks::gated(shapes::sphere(4));
    const ChartMap charts = random_charts(mesh, 12, 1);
    Progress progress([](double, const char*) { return false; });
    EXPECT_THROW(smooth_seams(mesh, charts, {}, progress), Cancelled);
}

TEST(SmoothSeams, RefuseOptionsOutOfRange) {
    const Mesh mesh = checks::gated(shapes::sphere(1));
    SmoothOptions options;
    options.smoothness = -1.0;
    Progress progress;
    EXPECT_THROW(smooth_seams(mesh, checks::components(mesh), options, progress), InvalidParameter);
}

} // namespace
} // namespace devseg::curves
