// Gluing darts, cutting off overlaps, joining small charts; the filters around patterns.
#include <cmath>

#include <gtest/gtest.h>

#include "devseg/pattern/optimize.h"
#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/pattern_samples.h"
#include "unit/shapes.h"

namespace devseg::pattern {
namespace {

using samples::Cloth;

const char* const optimize = "Pattern: Optimize for Fabrication";

declare::HostResult optimized(const Cloth& cloth, const declare::ParameterValues& values = {}) {
    return checks::run(optimize, cloth.host(), values);
}

double count(const declare::HostResult& result, const char* name) {
    return checks::value(result, name);
}

Index overlapping_faces(const declare::HostMesh& host) {
    return static_cast<Index>(
        checks::value(checks::run("Charts: Measure Flattening", host), "overlapping_faces_number"));
}

int seams(const declare::HostResult& result) {
    int edges = 0;
    for (const int bits : result.seam_edges)
        edges += (bits & 1) + (bits >> 1 & 1) + (bits >> 2 & 1);
    return edges / 2;
}

TEST(OptimizePattern, NarrowDartsAreGluedAndWideOnesStay) {
    const Cloth narrow = samples::with_dart(2.0);
    EXPECT_EQ(narrow.pattern().seams.size(), 1U);
    const declare::HostResult glued = optimized(narrow);
    EXPECT_EQ(count(glued, "glued_darts_number"), 1);
    EXPECT_GE(count(glued, "glued_edges_number"), 1);
    EXPECT_EQ(seams(glued), 4 - count(glued, "glued_edges_number"));
    const declare::HostResult wide = optimized(samples::with_dart(20.0));
    EXPECT_EQ(count(wide, "glued_darts_number"), 0);
    EXPECT_EQ(seams(wide), 4);
    EXPECT_EQ(wide.wedge_uv, samples::with_dart(20.0).host().wedge_uv);
    // A slit that does not open at all vanishes.
    const declare::HostResult closed = optimized(samples::with_dart(0.002));
    EXPECT_EQ(count(closed, "glued_edges_number"), 4);
    EXPECT_EQ(seams(closed), 0);
}

TEST(OptimizePattern, GluedEdgesAreOneInTheTexture) {
    const Cloth cloth = samples::with_dart(0.5);
    const Mesh mesh = cloth.mesh();
    const CornerUv uv = cloth.uv();
    const GluedDarts glued = glue_darts(mesh, atlas::charts_from_uv(mesh, uv), uv, 0.05);
    const atlas::ChartMap read = atlas::charts_from_uv(mesh, glued.uv);
    EXPECT_EQ(read.seam, glued.charts.seam);
    for (const Face f : mesh.all_faces())
        EXPECT_GT(plane::uv_area(glued.uv, f), 0.0);
}

TEST(OptimizePattern, TheOnlyOutlineOfAChartStays) {
    // A cube cut open along a path is one chart around one slit: gluing all of it would close it.
    const Mesh mesh = checks::gated(shapes::sphere(1));
    std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    seam[0] = seam[mesh.twin[0]] = 1;
    const atlas::ChartMap charts =
        atlas::make_chart_map(mesh, std::vector<Index>(mesh.faces.size(), 0), seam, false);
    CornerUv uv;
    for (const Triangle& t : mesh.faces)
        for (const Index v : t)
            uv.push_back(mesh.points[v].head<2>());
    EXPECT_EQ(glue_darts(mesh, charts, uv, 10.0).edges, 0);
}

TEST(OptimizePattern, PartsThatLieOnOthersAreCutOff) {
    Cloth cloth;
    cloth.add(shapes::helix_strip(60, 1.3, 20.0, 30.0, 0.5),
              [](const Vec3& p, const Vec3&) { return samples::flat(p); });
    EXPECT_GT(overlapping_faces(cloth.host()), 0);
    const declare::HostResult result = optimized(cloth);
    EXPECT_GE(count(result, "overlap_cuts_number"), 1);
    EXPECT_GE(count(result, "charts_number"), 2);
    declare::HostMesh host = cloth.host();
    host.wedge_uv = result.wedge_uv;
    EXPECT_EQ(overlapping_faces(host), 0);
    checks::expect_agreement(host.geometry, result);
    // Switched off, the layout stays as it is.
    const declare::HostResult kept = optimized(cloth, {{"remove_overlaps", false}});
    EXPECT_EQ(kept.wedge_uv, cloth.host().wedge_uv);
}

// A plate with a small chart in its corner; `bend` is the angle (degrees) that it stands up by.
Cloth with_corner(double bend) {
    mesh::RawMesh plate = shapes::grid(10, 10, 100.0, 100.0);
    const double angle = bend * shapes::pi / 180.0;
    for (Vec3& p : plate.points)
        if (p.x() + p.y() > 185.0)
            p.z() = (p.x() + p.y() - 180.0) * std::tan(angle);
    Cloth cloth;
    cloth.add(plate, [](const Vec3& p, const Vec3& middle) {
        const bool corner = middle.x() > 80.0 && middle.y() > 80.0;
        return Vec2(samples::flat(p) + Vec2(corner ? 20.0 : 0.0, 0.0));
    });
    return cloth;
}

TEST(OptimizePattern, SmallChartsAreJoinedWhereThatIsDevelopable) {
    const Cloth cloth = with_corner(0.0);
    EXPECT_EQ(cloth.pattern().pieces.size(), 2U);
    const declare::ParameterValues small{{"max_gusset_area", 0.05}};
    const declare::HostResult joined = optimized(cloth, small);
    EXPECT_EQ(count(joined, "reattached_charts_number"), 1);
    EXPECT_EQ(count(joined, "charts_number"), 1);
    EXPECT_EQ(seams(joined), 0);
    for (const int id : joined.chart_id)
        EXPECT_EQ(id, 0);
    declare::HostMesh host = cloth.host();
    host.wedge_uv = joined.wedge_uv;
    EXPECT_EQ(overlapping_faces(host), 0);
    // Not small enough, not developable enough, or not wanted.
    EXPECT_EQ(count(optimized(cloth), "reattached_charts_number"), 0); // 4 % is above 2 %
    EXPECT_EQ(
        count(optimized(with_corner(60.0), {{"max_gusset_area", 0.05}, {"merge_threshold", 1e-6}}),
              "reattached_charts_number"),
        0);
    EXPECT_EQ(count(optimized(cloth, {{"max_gusset_area", 0.05}, {"reattach_gussets", false}}),
                    "reattached_charts_number"),
              0);
}

TEST(OptimizePattern, CoordinatesWithoutAreaAreRefused) {
    declare::HostMesh host = samples::two_pieces().host();
    for (auto& corners : host.wedge_uv)
        corners = {Vec2(1, 1), Vec2(1, 1), Vec2(1, 1)};
    const std::string text = checks::error_of<InvalidMesh>([&] { checks::run(optimize, host); });
    EXPECT_TRUE(checks::contains(text, "cover an area"));
}

TEST(PatternLayer, LiesFlatInMillimetresAndKnowsItsFaces) {
    const Cloth cloth = samples::two_pieces();
    const declare::HostResult result =
        checks::run("Pattern: Generate Pieces", cloth.host(), {{"mm_per_unit", 2.0}});
    ASSERT_TRUE(result.layer.has_value());
    const declare::LayerMesh& layer = *result.layer;
    const std::size_t faces = cloth.host().geometry.faces.size();
    ASSERT_EQ(layer.geometry.faces.size(), faces);
    ASSERT_EQ(layer.face_color.size(), faces);
    ASSERT_EQ(layer.face_attributes.size(), 2U);
    std::vector<int> seen(faces, 0);
    double area = 0.0;
    for (std::size_t f = 0; f < faces; ++f) {
        const std::size_t source = at(layer.face_attributes[1].second[f]);
        ++seen[source];
        EXPECT_NEAR(checks::area_on_surface(layer.geometry, f),
                    4.0 * checks::area_on_surface(cloth.host().geometry, source), 1e-6);
        const Triangle& t = layer.geometry.faces[f];
        const Vec3 normal = (layer.geometry.points[t[1]] - layer.geometry.points[t[0]])
                                .cross(layer.geometry.points[t[2]] - layer.geometry.points[t[0]]);
        EXPECT_GT(normal.z(), 0.0);
        area += 0.5 * normal.z();
        EXPECT_EQ(layer.face_color[f], (declare::Color{255, 255, 255})); // no strain
    }
    EXPECT_EQ(seen, std::vector<int>(faces, 1));
    EXPECT_NEAR(area, 4.0 * 6400.0, 1e-3);
    EXPECT_EQ(count(result, "pieces_number"), 2);
}

// Of two sheets, one is a fifth longer on paper; its cloth is compressed on the model.
TEST(PatternLayer, UseOfLimitsIsColoured) {
    Cloth cloth;
    cloth.add(shapes::grid(2, 2, 10.0, 10.0), [](const Vec3& p, const Vec3&) {
        return Vec2(p.x() > 5.0 ? 5.0 + 1.2 * (p.x() - 5.0) : p.x(), p.y());
    });
    const auto layer = [&](const std::string& material) {
        return *checks::run("Pattern: Generate Pieces", cloth.host(), {{"material", material}})
                    .layer;
    };
    const declare::LayerMesh within = layer("neoprene, warp=1, weft=1, bias=1, compression=0.9");
    for (const double use : within.face_quality)
        EXPECT_LT(std::abs(use), 1.0);
    for (const declare::Color& c : within.face_color)
        EXPECT_EQ(std::max(c[0], c[2]), 255);
    const declare::LayerMesh above = layer("leather");
    const auto [least, most] =
        std::minmax_element(above.face_quality.begin(), above.face_quality.end());
    EXPECT_LT(*least, -2.0);
    EXPECT_GT(*most, 2.0);
    for (std::size_t f = 0; f < above.face_color.size(); ++f)
        EXPECT_EQ(above.face_color[f], (above.face_quality[f] > 0.0 ? declare::Color{128, 0, 0}
                                                                    : declare::Color{0, 0, 128}));
}

TEST(PatternLayer, StrainIsColoured) {
    Cloth cloth;
    cloth.add(shapes::grid(2, 2, 10.0, 10.0), [](const Vec3& p, const Vec3&) {
        return Vec2(p.x() > 5.0 ? 5.0 + 1.2 * (p.x() - 5.0) : p.x(), p.y());
    });
    const declare::LayerMesh layer = *checks::run("Pattern: Generate Pieces", cloth.host()).layer;
    for (std::size_t f = 0; f < layer.geometry.faces.size(); ++f) {
        const bool right = layer.geometry.points[layer.geometry.faces[f][1]].x() > 5.0;
        const declare::Color& c = layer.face_color[f];
        if (layer.face_quality[f] > 0.0)
            EXPECT_EQ(c[0], 255);
        else
            EXPECT_EQ(c[2], 255);
        EXPECT_LT(c[1], 255);
        EXPECT_TRUE(right || layer.face_quality[f] < 0.0);
    }
}

TEST(PatternMeasures, AreThoseOfThePattern) {
    const declare::HostResult result =
        checks::run("Pattern: Measure", samples::two_pieces().host());
    EXPECT_EQ(count(result, "pieces_number"), 2);
    EXPECT_EQ(count(result, "shapes_number"), 1);
    EXPECT_EQ(count(result, "seams_number"), 1);
    EXPECT_EQ(count(result, "darts_number"), 0);
    EXPECT_EQ(count(result, "notches_number"), 2);
    EXPECT_EQ(count(result, "mismatched_seams_number"), 0);
    EXPECT_NEAR(count(result, "area_mm2"), 6400.0, 1e-3);
    EXPECT_NEAR(count(result, "largest_piece_mm"), 80.0, 1e-5);
    EXPECT_NEAR(count(result, "max_extension"), 0.0, 1e-6);
}

} // namespace
} // namespace devseg::pattern
