// Deformation to exact developability and exact unfolding.
#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "devseg/base/errors.h"
#include "devseg/develop/angle_constraints.h"
#include "devseg/develop/attempts.h"
#include "devseg/develop/deform.h"
#include "devseg/develop/intersections.h"
#include "devseg/flatten/flatten.h"
#include "devseg/flatten/maps/unfold.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/methods/papercraft/papercraft.h"
#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::develop {
namespace {

std::vector<Index> own_points(const Mesh& mesh) {
    std::vector<Index> point_of;
    for (const Vertex v : mesh.all_vertices())
        point_of.push_back(v);
    return point_of;
}

DeformResult deform(const Mesh& mesh, const atlas::ChartMap& charts,
                    const DeformOptions& options = {}) {
    Progress progress;
    return deform_to_developable(mesh, charts, own_points(mesh), options, progress);
}

Mesh with_points(Mesh mesh, const std::vector<Vec3>& points) {
    mesh.points = points;
    mesh::compute_face_geometry(mesh);
    return mesh;
}

// The largest |2π − Σ θ| over vertices without cut or boundary edges, by the law of cosines.
double worst_defect(const Mesh& mesh, const std::vector<std::uint8_t>& seam) {
    std::vector<double> sum(mesh.points.size(), 0.0);
    std::vector<bool> outer(mesh.points.size(), false);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const double a = mesh.edge_length(h);
        const double b = mesh.edge_length(Mesh::previous(h));
        const double c = mesh.edge_length(Mesh::next(h));
        sum[mesh.origin(h)] += std::acos((a * a + b * b - c * c) / (2.0 * a * b));
        if (seam[h] != 0 || mesh.twin[h] < 0)
            outer[mesh.origin(h)] = outer[mesh.target(h)] = true;
    }
    double worst = 0.0;
    for (std::size_t v = 0; v < sum.size(); ++v)
        if (!outer[v])
            worst = std::max(worst, std::abs(2.0 * shapes::pi - sum[v]));
    return worst;
}

Mesh lumpy_torus() {
    return checks::gated(shapes::with_noise(shapes::torus(48, 24, 2.0, 0.9), 0.02, 4));
}

struct Deformed {
    explicit Deformed(const Mesh& start, int charts) : mesh(start) {
        papercraft::PapercraftOptions options;
        options.charts_number = charts;
        Progress progress;
        result = deform(start, papercraft::segment_papercraft(start, options, progress).charts);
        mesh = with_points(start, result.points);
    }
    Mesh mesh;
    DeformResult result;
};

TEST(AngleConstraints, GradientsAreThoseOfFiniteDifferences) {
    const Mesh mesh = checks::gated(shapes::with_noise(shapes::sphere(1), 0.1, 2));
    const std::vector<Index> vertices{3, 7, 20};
    AngleConstraints constraints(mesh, vertices, own_points(mesh));
    constraints.linearise(mesh.points);
    const std::vector<double> ones(mesh.points.size(), 1.0);
    const double step = 1e-6;
    for (Index r = 0; r < 3; ++r) {
        const std::vector<Vec3> gradient =
            constraints.displacement(ones, Eigen::VectorXd::Unit(3, r));
        for (std::size_t p = 0; p < mesh.points.size(); ++p)
            for (int k = 0; k < 3; ++k) {
                std::vector<Vec3> more = mesh.points;
                std::vector<Vec3> less = mesh.points;
                more[p][k] += step;
                less[p][k] -= step;
                const double change = constraints.defects(less)[r] - constraints.defects(more)[r];
                EXPECT_NEAR(gradient[p][k], change / (2.0 * step), 1e-7);
            }
    }
    const Normal& matrix = constraints.normal_matrix(ones, Eigen::VectorXd::Constant(3, 0.25));
    for (Index r = 0; r < 3; ++r)
        for (Index s = 0; s <= r; ++s) {
            const auto a = constraints.displacement(ones, Eigen::VectorXd::Unit(3, r));
            const auto b = constraints.displacement(ones, Eigen::VectorXd::Unit(3, s));
            double product = r == s ? 0.25 : 0.0;
            for (std::size_t p = 0; p < a.size(); ++p)
                product += a[p].dot(b[p]);
            EXPECT_NEAR(matrix.coeff(r, s), product, 1e-12);
        }
}

TEST(Deform, ChartsBecomeExactlyDevelopable) {
    const Mesh start = lumpy_torus();
    const Deformed d(start, 8);
    EXPECT_GT(d.result.start_residual, 0.01);
    EXPECT_TRUE(d.result.converged);
    EXPECT_LE(worst_defect(d.mesh, d.result.charts.seam), 1e-9);
    EXPECT_GT(d.result.inner_vertices, start.vertex_count() / 2);
    EXPECT_EQ(d.result.new_intersections, 0);
    double largest = 0.0;
    double sum = 0.0;
    for (std::size_t v = 0; v < start.points.size(); ++v) {
        const double moved = (d.mesh.points[v] - start.points[v]).norm();
        largest = std::max(largest, moved);
        sum += moved;
    }
    EXPECT_NEAR(d.result.largest_displacement, largest, 1e-12);
    EXPECT_NEAR(d.result.mean_displacement, sum / start.vertex_count(), 1e-12);
    EXPECT_LT(largest * start.unit_length, 0.3); // of a torus of 5.8
    for (const Face f : start.all_faces())
        EXPECT_GT(start.face_normals[f].dot(d.mesh.face_normals[f]), 0.0);
}

TEST(Deform, WhatIsDevelopableStays) {
    const Mesh mesh = checks::gated(shapes::folded_strip(8, 6, 0.7));
    const DeformResult r = deform(mesh, checks::components(mesh));
    EXPECT_EQ(r.largest_displacement, 0.0);
    EXPECT_EQ(r.rounds, 0);
    EXPECT_TRUE(r.converged);
}

TEST(Deform, SlitsStayWhereTheyMustNotBeAdjusted) {
    const Mesh mesh = checks::gated(shapes::with_noise(shapes::hemisphere(32, 10), 0.01, 1));
    papercraft::PapercraftOptions options;
    options.charts_number = 6;
    options.slit_threshold = 0.0;
    Progress progress;
    const atlas::ChartMap charts = papercraft::segment_papercraft(mesh, options, progress).charts;
    const DeformResult r = deform(mesh, charts, {200, 1e-6, false, false});
    EXPECT_EQ(r.charts.seam, charts.seam);
    EXPECT_LE(worst_defect(with_points(mesh, r.points), charts.seam), 1e-6);
}

TEST(Deform, WhatCannotConvergeIsRefusedOrReturnedOnRequest) {
    // A sphere with a short slit: curvature of 4π has nowhere to go.
    const checks::Disk disk(shapes::sphere(2));
    EXPECT_THROW(deform(disk.mesh, disk.charts, {20, 1e-6, false, false}), NumericalFailure);
    const std::string text = checks::error_of<NumericalFailure>([&] {
        deform(disk.mesh, disk.charts, {20, 1e-6, false, false});
    });
    EXPECT_TRUE(checks::contains(text, "expected angle sums of 2 pi"));
    EXPECT_TRUE(checks::contains(text, "keep_unfinished"));
    const DeformResult r = deform(disk.mesh, disk.charts, {20, 1e-6, false, true});
    EXPECT_FALSE(r.converged);
    EXPECT_NEAR(r.residual, worst_defect(with_points(disk.mesh, r.points), r.charts.seam), 1e-6);
}

TEST(Deform, TheSameSphereConvergesWithMoreSlits) {
    const checks::Disk disk(shapes::sphere(2));
    const DeformResult r = deform(disk.mesh, disk.charts, {400, 1e-6, true, false});
    EXPECT_TRUE(r.converged);
    EXPECT_GT(r.added_slits, 0);
    EXPECT_TRUE(checks::is_valid(disk.mesh, r.charts));
    EXPECT_LE(worst_defect(with_points(disk.mesh, r.points), r.charts.seam), 1e-6);
    EXPECT_EQ(checks::topology(disk.mesh, r.charts, 0).euler, 1);
}

// Two shells, nearer to each other than they have to move.
struct Shells {
    Shells() {
        const mesh::RawMesh shell = shapes::with_noise(shapes::sphere(3), 0.003, 8);
        const mesh::RawMesh inside = shapes::with_noise(shapes::sphere(3), 0.003, 9);
        mesh = checks::gated(shapes::join(shell, shapes::moved(inside, 0.975, Vec3::Zero())));
        papercraft::PapercraftOptions options;
        options.charts_number = 12;
        Progress progress;
        charts = papercraft::segment_papercraft(mesh, options, progress).charts;
    }
    Mesh mesh;
    atlas::ChartMap charts;
};

TEST(Deform, SurfacesThatWouldCrossAreRefusedWhereSlitsMustStay) {
    const Shells shells;
    Progress progress;
    ASSERT_TRUE(find_intersections(shells.mesh.points, shells.mesh.faces, progress).empty());
    DeformOptions anyway;
    anyway.adjust_slits = false;
    anyway.keep_unfinished = true;
    const DeformResult r = deform(shells.mesh, shells.charts, anyway);
    EXPECT_TRUE(r.converged);
    EXPECT_EQ(r.new_intersections,
              static_cast<Index>(find_intersections(r.points, shells.mesh.faces, progress).size()));
    EXPECT_GT(r.new_intersections, 0); // they are too close, and so it is refused
    anyway.keep_unfinished = false;
    const std::string text =
        checks::error_of<NumericalFailure>([&] { deform(shells.mesh, shells.charts, anyway); });
    EXPECT_TRUE(checks::contains(text, "new pairs of faces that intersect"));
}

TEST(Deform, SurfacesThatWouldCrossAreCutUntilTheyDoNot) {
    const Shells shells;
    const DeformResult r = deform(shells.mesh, shells.charts);
    EXPECT_TRUE(r.converged);
    EXPECT_TRUE(find_intersections(r.points, shells.mesh.faces, Progress()).empty());
    EXPECT_LE(worst_defect(with_points(shells.mesh, r.points), r.charts.seam), 1e-6);
    EXPECT_TRUE(checks::is_valid(shells.mesh, r.charts));
    // Charts that do not come near others still bend.
    EXPECT_GT(r.inner_vertices, shells.mesh.vertex_count() / 8);
}

TEST(Deform, VerticesMoveNoFartherThanTheyMay) {
    const Mesh start = lumpy_torus();
    papercraft::PapercraftOptions options;
    options.charts_number = 6;
    Progress progress;
    const atlas::ChartMap charts = papercraft::segment_papercraft(start, options, progress).charts;
    Eigen::AlignedBox3d box;
    for (const Vec3& p : start.points)
        box.extend(p);
    const auto shares = [&](double largest, double mean) {
        DeformOptions bounds;
        bounds.max_displacement = largest;
        bounds.max_mean_displacement = mean;
        const DeformResult r = deform(start, charts, bounds);
        EXPECT_LE(worst_defect(with_points(start, r.points), r.charts.seam), 1e-6);
        return std::pair(r.largest_displacement / box.diagonal().norm(),
                         r.mean_displacement / box.diagonal().norm());
    };
    const auto free = shares(0.0, 0.0);
    EXPECT_LE(shares(0.5 * free.first, 0.0).first, 0.5 * free.first);
    EXPECT_LE(shares(0.0, 0.5 * free.second).second, 0.5 * free.second);
}

// All of its angles are alike, and as small as its faces are.
TEST(Deform, AFineSphereGetsAFewSlitsWhereItMovesTooFar) {
    const Mesh start = checks::gated(shapes::sphere(4));
    papercraft::PapercraftOptions options;
    options.charts_number = 8;
    Progress progress;
    const atlas::ChartMap charts = papercraft::segment_papercraft(start, options, progress).charts;
    const DeformResult r = deform(start, charts);
    EXPECT_LE(r.mean_displacement, 0.003 * diagonal_of(start.points));
    EXPECT_LE(worst_defect(with_points(start, r.points), r.charts.seam), 1e-6);
    EXPECT_GT(r.added_slits, 0);
    EXPECT_LE(r.added_slits, 5 * r.charts.count);
}

TEST(Deform, ChartsThatStandStillAreOpenedWhereTheyAreNotFlat) {
    const Mesh mesh = checks::gated(shapes::cube(4));
    DeformResult result;
    result.points = mesh.points;
    result.charts = checks::components(mesh);
    Attempt attempt{std::vector<double>(mesh.points.size(), 1.0),
                    std::vector<std::uint8_t>(mesh.points.size(), 0)};
    attempt.faulty = 20; // late
    ASSERT_TRUE(learn(mesh, own_points(mesh), {}, result, {{0, 1}}, attempt));
    EXPECT_EQ(std::count(attempt.opened.begin(), attempt.opened.end(), 1), 8); // its corners
    EXPECT_EQ(std::count(attempt.ease.begin(), attempt.ease.end(), 0.0),
              static_cast<std::ptrdiff_t>(mesh.points.size()));
}

TEST(Deform, VerticesThatShareAPointStayTogether) {
    // Two fans that touch in a vertex of the host: the gate splits it.
    mesh::RawMesh raw = shapes::with_noise(shapes::hemisphere(12, 4), 0.02, 1);
    const mesh::RawMesh other = shapes::moved(raw, -1.0, 2.0 * raw.points[0]);
    mesh::RawMesh both = shapes::join(raw, other);
    const Index offset = static_cast<Index>(raw.points.size());
    for (Triangle& t : both.faces)
        for (Index& v : t)
            v = (both.points[v] - both.points[0]).norm() < 1e-9 ? 0 : v;
    const mesh::GatedMesh gated = mesh::gate_mesh(both);
    ASSERT_GT(offset, 0);
    ASSERT_NE(std::count(gated.source_vertex.begin(), gated.source_vertex.end(), 0), 0);
    const std::vector<Index> point_of(gated.source_vertex.begin(), gated.source_vertex.end());
    Progress progress;
    const DeformResult r = deform_to_developable(
        gated.mesh, checks::components_cut_to_disks(gated.mesh), point_of, {}, progress);
    Vec3 shared = Vec3::Zero();
    Index copies = 0;
    for (std::size_t v = 0; v < point_of.size(); ++v)
        if (point_of[v] == 0) {
            if (copies++ == 0)
                shared = r.points[v];
            EXPECT_EQ(r.points[v], shared);
        }
    EXPECT_EQ(copies, 2);
}

TEST(Intersections, CrossingCountsAndTouchingDoesNot) {
    const std::vector<Vec3> points{{0, 0, 0},     {2, 0, 0},   {0, 2, 0},   {0.5, 0.5, -1},
                                   {0.5, 0.5, 1}, {3, 3, 0.5}, {1, 0.5, 0}, {0.2, 0.2, 0}};
    const std::vector<Triangle> faces{
        {0, 1, 2}, // in the plane
        {3, 4, 5}, // through it
        {6, 4, 5}, // with a corner on it
        {0, 4, 5}, // from its corner, beside it
    };
    using Pairs = std::vector<std::pair<Index, Index>>;
    EXPECT_EQ(find_intersections(points, {faces[0], faces[1]}, Progress()), (Pairs{{0, 1}}));
    EXPECT_EQ(find_intersections(points, {faces[0], faces[2]}, Progress()), Pairs{});
    EXPECT_EQ(find_intersections(points, {faces[0], faces[3]}, Progress()), Pairs{});
    // With a common corner, but the opposite edge runs through the inside.
    EXPECT_EQ(find_intersections(points, {faces[0], {0, 3, 4}}, Progress()), (Pairs{{0, 1}}));
    EXPECT_EQ(find_intersections(lumpy_torus().points, lumpy_torus().faces, Progress()), Pairs{});
}

TEST(Intersections, TheTreeFindsWhatAllPairsFind) {
    mesh::RawMesh raw =
        shapes::join(shapes::sphere(2),
                     shapes::moved(shapes::torus(20, 10, 1.0, 0.4), 1.0, Vec3(0.3, 0.2, 0.1)));
    const auto all = find_intersections(raw.points, raw.faces, Progress());
    EXPECT_GT(all.size(), 20U);
    std::vector<std::pair<Index, Index>> one_by_one;
    const Index count = static_cast<Index>(raw.faces.size());
    for (Index f = 0; f < count; ++f)
        for (Index g = f + 1; g < count; ++g)
            if (!find_intersections(raw.points, {raw.faces[f], raw.faces[g]}, Progress()).empty())
                one_by_one.emplace_back(f, g);
    EXPECT_EQ(all, one_by_one);
}

// The chart folded back: each face beside its neighbour, turned by the fold angle of their edge.
std::vector<Vec3> fold_back(const Mesh& mesh, const atlas::ChartSurface& surface,
                            const std::vector<Vec2>& uv) {
    std::vector<Eigen::Isometry3d> place(surface.face.size(), Eigen::Isometry3d::Identity());
    std::vector<bool> seen(surface.face.size(), false);
    std::vector<Vec3> folded(surface.vertex.size());
    const auto flat = [&](Index v) { return Vec3(uv[v].x(), uv[v].y(), 0.0); };
    std::vector<Index> queue{0};
    seen[0] = true;
    for (std::size_t i = 0; i < queue.size(); ++i) {
        const Index f = queue[i];
        for (const HalfEdge h : half_edges_of(f)) {
            folded[surface.origin(h)] = place[f] * flat(surface.origin(h));
            const Index other = surface.twin[h];
            if (other < 0 || seen[other / 3])
                continue;
            const Vec3& n = mesh.face_normals[surface.face[f]];
            const Vec3& m = mesh.face_normals[surface.face[other / 3]];
            const Vec3 edge = (mesh.points[surface.vertex[surface.target(h)]] -
                               mesh.points[surface.vertex[surface.origin(h)]])
                                  .normalized();
            const double angle = std::atan2(n.cross(m).dot(edge), n.dot(m));
            const Vec3 a = flat(surface.origin(h));
            const Vec3 axis = (flat(surface.target(h)) - a).normalized();
            place[other / 3] = place[f] * Eigen::Translation3d(a) * Eigen::AngleAxisd(angle, axis) *
                               Eigen::Translation3d(-a);
            seen[other / 3] = true;
            queue.push_back(other / 3);
        }
    }
    return folded;
}

void expect_folds_back(const Mesh& mesh, const atlas::ChartSurface& surface,
                       const std::vector<Vec2>& uv) {
    const std::vector<Vec3> folded = fold_back(mesh, surface, uv);
    Eigen::Matrix3Xd from(3, folded.size());
    Eigen::Matrix3Xd to(3, folded.size());
    for (std::size_t v = 0; v < folded.size(); ++v) {
        from.col(static_cast<Eigen::Index>(v)) = folded[v];
        to.col(static_cast<Eigen::Index>(v)) = mesh.points[surface.vertex[v]];
    }
    const Eigen::Matrix4d rigid = Eigen::umeyama(from, to, false);
    for (Eigen::Index v = 0; v < from.cols(); ++v)
        EXPECT_LT((rigid * from.col(v).homogeneous() - to.col(v).homogeneous()).norm(), 1e-6);
}

TEST(Unfold, DeformedChartsUnfoldWithoutStretchAndFoldBack) {
    const Deformed d(lumpy_torus(), 8);
    Progress progress;
    const flatten::FlattenResult flat =
        flatten::flatten_charts(d.mesh, d.result.charts, flatten::FlattenMethod::lscm, progress);
    EXPECT_GE(flat.charts.count, d.result.charts.count);
    for (const flatten::FlatChart& chart : flat.flat) {
        EXPECT_TRUE(chart.developed);
        for (const HalfEdge h : chart.surface.all_half_edges())
            EXPECT_NEAR(
                (chart.uv[chart.surface.target(h)] - chart.uv[chart.surface.origin(h)]).norm(),
                d.mesh.edge_length(chart.surface.mesh_half_edge(h)), 1e-9);
        expect_folds_back(d.mesh, chart.surface, chart.uv);
    }
}

TEST(Unfold, WhatIsNotDevelopableIsNotUnfolded) {
    for (const mesh::RawMesh& raw : {shapes::hemisphere(16, 6), shapes::sphere(2)}) {
        const checks::Disk disk(raw);
        EXPECT_FALSE(flatten::unfold(disk.problem).has_value());
    }
    const checks::Disk strip(shapes::folded_strip(8, 6, 0.7));
    EXPECT_TRUE(flatten::unfold(strip.problem).has_value());
}

TEST(Unfold, DevelopmentsThatLieOnThemselvesAreSeparated) {
    const Mesh mesh = checks::gated(shapes::zigzag_fan(24, shapes::pi / 8.0, 1.0, 2.0, 4));
    Progress progress;
    const flatten::FlattenResult flat = flatten::flatten_charts(
        mesh, checks::components(mesh), flatten::FlattenMethod::symmetric_dirichlet, progress);
    EXPECT_EQ(flat.cuts, 1);
    EXPECT_EQ(flat.charts.count, 2);
    double area = 0.0;
    for (const flatten::FlatChart& chart : flat.flat) {
        EXPECT_TRUE(chart.developed);
        EXPECT_FALSE(chart.pushed);
        for (const Triangle& t : chart.surface.faces) {
            const Vec2 a = chart.uv[t[1]] - chart.uv[t[0]];
            const Vec2 b = chart.uv[t[2]] - chart.uv[t[0]];
            area += 0.5 * (a.x() * b.y() - a.y() * b.x());
        }
    }
    EXPECT_NEAR(area, mesh.total_area, 1e-9 * mesh.total_area);
}

// A ring in a zigzag, cut along one ray, with a little more than a full turn around its middle: the
// sides of the cut lie on each other in the plane.
Index parts_of_ring(double excess) {
    mesh::RawMesh raw = shapes::annulus(16, 2, 1.0, 2.0);
    const double turn = 2.0 * shapes::pi / 16.0;
    const double c = (std::cos(turn + excess / 16.0) + 1.0) / (std::cos(turn) + 1.0);
    const double psi = std::acos(std::sqrt(c)); // as in zigzag_fan
    std::vector<std::uint8_t> on_ray;
    for (Vec3& p : raw.points) {
        const int i = static_cast<int>(std::lround(std::atan2(p.y(), p.x()) / turn));
        on_ray.push_back(i == 0 ? 1 : 0);
        const double r = p.norm();
        p *= std::cos(psi);
        p.z() = r * std::sin(i % 2 == 0 ? psi : -psi);
    }
    const Mesh mesh = checks::gated(raw);
    std::vector<std::uint8_t> seam;
    for (const HalfEdge h : mesh.all_half_edges())
        seam.push_back(mesh.twin[h] >= 0 ? on_ray[mesh.origin(h)] & on_ray[mesh.target(h)] : 0);
    const std::vector<Index> labels(mesh.faces.size(), 0);
    Progress progress;
    const flatten::FlattenResult flat =
        flatten::flatten_charts(mesh, atlas::make_chart_map(mesh, labels, seam, false),
                                flatten::FlattenMethod::symmetric_dirichlet, progress);
    for (const flatten::FlatChart& chart : flat.flat) {
        EXPECT_TRUE(chart.developed);
        EXPECT_TRUE(flatten::is_one_to_one(chart.surface, chart.uv));
    }
    return flat.charts.count;
}

TEST(Unfold, OverlapsThatPaperDoesNotShowAreNoReasonToCut) {
    EXPECT_EQ(parts_of_ring(1e-5), 1);
    EXPECT_EQ(parts_of_ring(1e-2), 2);
}

TEST(Unfold, ASmallPartIsHingedToANeighbour) {
    // The same with one sector more than fits, and a sheet at either end.
    mesh::RawMesh raw = shapes::zigzag_fan(17, shapes::pi / 8.0, 1.0, 2.0, 1);
    const auto add_sheet = [&](Index a, Index b, const Vec3& offset) {
        const Index n = static_cast<Index>(raw.points.size());
        raw.points.push_back(raw.points[a] + offset);
        raw.points.push_back(raw.points[b] + offset);
        raw.faces.push_back({a, n, b});
        raw.faces.push_back({n, n + 1, b});
    };
    add_sheet(17, 17 + 18, Vec3(0.7, 0.2, 0.3)); // points run along rows of 18
    add_sheet(18, 0, Vec3(0.7, -0.2, 0.3));
    const Mesh mesh = checks::gated(raw);
    std::vector<Index> labels(mesh.faces.size(), 0);
    for (std::size_t i = 1; i <= 4; ++i)
        labels[labels.size() - i] = i <= 2 ? 1 : 2;
    Progress progress;
    const flatten::FlattenResult flat =
        flatten::flatten_charts(mesh, atlas::make_chart_map(mesh, labels, {}, false),
                                flatten::FlattenMethod::symmetric_dirichlet, progress);
    EXPECT_EQ(flat.cuts, 1);
    EXPECT_EQ(flat.reattached, 1);
    EXPECT_EQ(flat.charts.count, 3);
    EXPECT_TRUE(checks::is_valid(mesh, flat.charts));
    ASSERT_EQ(flat.flat.size(), 3U);
    for (std::size_t c = 0; c < 3; ++c)
        for (const Index f : flat.flat[c].surface.face)
            EXPECT_EQ(flat.charts.chart[f], static_cast<Index>(c));
}

} // namespace
} // namespace devseg::develop
