// Faces that a filter splits, as the host gets them.
#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::declare {
namespace {

mesh::RawMesh noisy_torus() {
    return shapes::with_noise(shapes::torus(24, 14, 2.0, 0.9), 0.03, 4);
}

double area_of(const mesh::RawMesh& raw) {
    double area = 0.0;
    for (std::size_t f = 0; f < raw.faces.size(); ++f)
        area += checks::area_on_surface(raw, f);
    return area;
}

HostMesh with_charts(const mesh::RawMesh& raw) {
    HostMesh host = checks::host_of(raw);
    checks::take_charts(host, checks::run("Segmentation: D-Charts", host));
    return host;
}

// What the filter leaves can be read again: the same charts, and seams as long as it says.
void expect_readable(const HostMesh& host, const HostResult& made) {
    HostMesh fine = checks::host_of(checks::refined(host.geometry, made));
    ASSERT_EQ(made.chart_id.size(), fine.geometry.faces.size());
    EXPECT_NEAR(area_of(fine.geometry), area_of(host.geometry), 1e-9);
    checks::take_charts(fine, made);
    const HostResult measured = checks::run("Charts: Measure Segmentation", fine);
    EXPECT_EQ(checks::value(measured, "charts_number"), checks::value(made, "charts_number"));
    EXPECT_EQ(checks::sound_charts(measured), checks::value(measured, "charts_number"));
    EXPECT_NEAR(checks::value(measured, "seam_length"), checks::value(made, "seam_length"), 1e-9);
    EXPECT_LT(checks::value(made, "seam_length"), checks::value(made, "seam_length_before"));
}

// Four faces around one in the middle unfold exactly: their seams may not move over corners for the
// sake of smoothness, as those of boxes may not.
TEST(RefinedFaces, ChartsThatUnfoldExactlyStillDo) {
    HostMesh host = checks::host_of(shapes::with_noise(shapes::sphere(1), 0.08, 1));
    for (std::size_t f = 0; f < host.geometry.faces.size(); ++f)
        host.chart_id.push_back(static_cast<double>(f / 4));
    const HostResult made =
        checks::run("Charts: Smooth Seams", host, {{"max_chart_l2_stretch", 1.02}});
    HostMesh fine = made.refinement ? checks::host_of(checks::refined(host.geometry, made)) : host;
    checks::take_charts(fine, made);
    fine.wedge_uv = checks::run("Charts: Flatten", fine).wedge_uv;
    const HostResult measured = checks::run("Charts: Measure Flattening", fine);
    EXPECT_EQ(checks::value(measured, "charts_number"), 20);
    EXPECT_LT(checks::value(measured, "l2_stretch"), 1.00001);
}

TEST(RefinedFaces, AgreeWithTheirNeighboursWhateverTheirOrientation) {
    for (std::uint32_t seed = 0; seed < 4; ++seed) {
        const mesh::RawMesh raw =
            seed == 0 ? noisy_torus() : shapes::with_random_orientations(noisy_torus(), seed);
        const HostMesh host = with_charts(raw);
        const HostResult made = checks::run("Charts: Smooth Seams", host);
        ASSERT_TRUE(made.refinement);
        checks::expect_agreement(checks::refined(raw, made), made);
        expect_readable(host, made);
        for (const HostRefinement::Part& part : made.refinement->parts) {
            // A part is turned as its face is.
            const mesh::RawMesh fine = checks::refined(raw, made);
            const auto normal = [](const mesh::RawMesh& m, const Triangle& t) {
                return Vec3(
                    (m.points[t[1]] - m.points[t[0]]).cross(m.points[t[2]] - m.points[t[0]]));
            };
            ASSERT_GT(normal(fine, part.corners).dot(normal(raw, raw.faces[part.source])), 0.0);
            if (part.face > static_cast<Index>(raw.faces.size()) + 20)
                break; // enough of them
        }
    }
}

double largest_chart_stretch(HostMesh host) {
    const HostResult flat = checks::run("Charts: Flatten", host);
    host.wedge_uv = flat.wedge_uv;
    checks::take_charts(host, flat);
    double largest = 0.0;
    for (const auto& [name, value] : checks::run("Charts: Measure Flattening", host).values)
        if (name == "chart_l2_stretch")
            for (const double l2 : std::get<std::vector<double>>(value))
                largest = std::max(largest, l2);
    return largest;
}

// Seams of the charts that would come out above the bound stay on their edges.
TEST(RefinedFaces, KeepABoundOnTheStretchOfCharts) {
    const HostMesh host = with_charts(noisy_torus());
    const auto smoothed = [&](double most) {
        const HostResult made =
            checks::run("Charts: Smooth Seams", host, {{"max_chart_l2_stretch", most}});
        HostMesh fine = checks::host_of(checks::refined(host.geometry, made));
        checks::take_charts(fine, made);
        return std::pair(largest_chart_stretch(fine), checks::value(made, "kept_charts_number"));
    };
    const double before = largest_chart_stretch(host);
    const auto [free, none] = smoothed(0.0);
    ASSERT_GT(free, before + 1e-4); // smoothing does raise it here
    EXPECT_EQ(none, 0.0);
    const double bound = 0.5 * (before + free);
    const auto [bounded, some] = smoothed(bound);
    EXPECT_LE(bounded, bound);
    EXPECT_GT(some, 0.0);
}

// Files such as STL: no two faces share a vertex, before and afterwards.
TEST(RefinedFaces, OfSeparateTrianglesStaySeparate) {
    const mesh::RawMesh whole = noisy_torus();
    mesh::RawMesh soup;
    for (const Triangle& t : whole.faces) {
        const auto first = static_cast<Index>(soup.points.size());
        for (const Index v : t)
            soup.points.push_back(whole.points[v]);
        soup.faces.push_back({first, first + 1, first + 2});
    }
    const HostMesh host = with_charts(soup);
    const HostResult made = checks::run("Charts: Smooth Seams", host);
    ASSERT_TRUE(made.refinement);
    const mesh::RawMesh fine = checks::refined(soup, made);
    std::vector<int> uses(fine.points.size(), 0);
    for (const Triangle& t : fine.faces)
        for (const Index v : t)
            EXPECT_EQ(++uses[v], 1);
    expect_readable(host, made);
}

// Parts of split faces that go to another chart take its colour, unless colours are not the
// charts'.
TEST(RefinedFaces, HaveTheColoursOfTheirCharts) {
    HostMesh host = with_charts(noisy_torus());
    host.face_color = checks::run("Charts: Colorize", host).face_color;
    std::map<int, Color> color;
    for (std::size_t f = 0; f < host.face_color.size(); ++f)
        color[static_cast<int>(host.chart_id[f])] = host.face_color[f];
    const HostResult made = checks::run("Charts: Smooth Seams", host);
    ASSERT_TRUE(made.refinement);
    ASSERT_EQ(made.face_color.size(), checks::refined(host.geometry, made).faces.size());
    for (std::size_t f = 0; f < made.face_color.size(); ++f)
        EXPECT_EQ(made.face_color[f], color.at(made.chart_id[f]));
    int moved = 0;
    for (const HostRefinement::Part& part : made.refinement->parts)
        moved += made.face_color[part.face] != host.face_color[part.source] ? 1 : 0;
    EXPECT_GT(moved, 0);

    host.face_color[7] = {1, 2, 3};
    EXPECT_TRUE(checks::run("Charts: Smooth Seams", host).face_color.empty());
    host.face_color.clear();
    EXPECT_TRUE(checks::run("Charts: Smooth Seams", host).face_color.empty());
}

// Faces that the gate leaves out keep their place and take the results of others.
TEST(RefinedFaces, LeaveOutWhatTheGateLeavesOut) {
    mesh::RawMesh raw = noisy_torus();
    const Triangle twice = raw.faces[5];
    raw.faces.insert(raw.faces.begin() + 100, twice);
    const HostMesh host = with_charts(raw);
    const HostResult made = checks::run("Charts: Smooth Seams", host);
    ASSERT_TRUE(made.refinement);
    const mesh::RawMesh fine = checks::refined(raw, made);
    EXPECT_EQ(fine.faces[100], twice);
    EXPECT_EQ(made.chart_id.size(), fine.faces.size());
    for (const HostRefinement::Part& part : made.refinement->parts)
        EXPECT_NE(part.source, 100);
}

// Far from the origin, 32 bits tell points apart by little.
TEST(AsStored, PointsLieWhereTheHostKeepsThem) {
    const mesh::RawMesh raw = noisy_torus();
    const Mesh mesh = checks::gated(raw);
    const std::vector<Index> none;
    const FilterInput input{mesh, {}, {}, none, none, {}, {}, Vec3(1000.1, -2000.3, 4000.7),
                            {},   {}, {}, {},   {},   {}, {}, {}};
    const Mesh stored = input.as_stored(input.mesh);
    double farthest = 0.0;
    for (const Vertex v : stored.all_vertices()) {
        const Vec3 p = input.to_model(stored.points[v]);
        const Vec3 given = input.to_model(input.mesh.points[v]);
        for (int k = 0; k < 3; ++k)
            EXPECT_NEAR(p[k], in_32_bits(given[k]), 1e-11);
        farthest = std::max(farthest, (p - given).norm());
    }
    EXPECT_GT(farthest, 1e-5);
    EXPECT_NE(stored.face_areas, input.mesh.face_areas);
}

} // namespace
} // namespace devseg::declare
