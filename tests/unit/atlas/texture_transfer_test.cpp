// Textures baked into another layout.
#include "devseg/atlas/texture_transfer.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/shapes.h"

namespace devseg::atlas {
namespace {

// Soft waves of three colours, as photographs have them.
plane::Image waves(int size) {
    plane::Image image{size, size, {}};
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            for (int k = 0; k < 3; ++k)
                image.rgb.push_back(static_cast<std::uint8_t>(std::lround(
                    127.0 + 100.0 * std::sin(0.05 * (k + 1) * x + k) * std::cos(0.04 * y + k))));
    return image;
}

CornerUv of_points(const Mesh& mesh, const Vec2& scale, const Vec2& shift, double turn) {
    CornerUv uv(mesh.twin.size());
    for (const HalfEdge h : mesh.all_half_edges())
        uv[h] = Eigen::Rotation2Dd(turn) *
                    scale.cwiseProduct(mesh.points[mesh.origin(h)].head<2>() * mesh.unit_length) +
                shift;
    return uv;
}

TEST(TextureTransfer, TheSurfaceLooksAsBefore) {
    const Mesh mesh = checks::gated(shapes::grid(12, 12));
    const CornerUv old = of_points(mesh, {0.8, 0.8}, {0.5, 0.5}, 0.0);
    CornerUv now = of_points(mesh, {0.6, 0.55}, {0.5, 0.5}, 0.4);
    // Two charts: the right half lies elsewhere.
    for (const Face f : mesh.all_faces())
        for (const HalfEdge h : half_edges_of(f))
            if (mesh.face_centers[f].x() > 0.0)
                now[h] += Vec2(0.02, 0.03);
    const std::vector<plane::Image> images{waves(512)};
    const std::vector<Index> page(mesh.faces.size(), 0);
    double filled = 0.0;
    const plane::Image baked =
        transfer_texture(mesh, now, {old, page, images}, 1024, 4, filled, Progress());
    EXPECT_GT(filled, 0.3);
    EXPECT_LT(filled, 0.5);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    double error = 0.0;
    const int count = 1000;
    for (int i = 0; i < count; ++i) {
        const Index f = static_cast<Index>(random() % mesh.faces.size());
        double a = share(random);
        double b = share(random);
        if (a + b > 1.0) {
            a = 1.0 - a;
            b = 1.0 - b;
        }
        const auto place = [&](const CornerUv& uv) -> Vec2 {
            return (1.0 - a - b) * uv[3 * f] + a * uv[3 * f + 1] + b * uv[3 * f + 2];
        };
        const auto before = plane::sample(images[0], place(old));
        const auto after = plane::sample(baked, place(now));
        for (std::size_t k = 0; k < 3; ++k)
            error += std::abs(before[k] - after[k]) / (3.0 * count);
    }
    EXPECT_LE(error, 2.0);
}

TEST(TextureTransfer, PaddingTakesTheColourOfTheBorder) {
    const Mesh mesh = checks::gated(shapes::grid(1, 1));
    const CornerUv now = of_points(mesh, {0.5, 0.5}, {0.5, 0.5}, 0.0);
    plane::Image red{1, 1, {200, 10, 20}};
    const std::vector<plane::Image> images{red};
    double filled = 0.0;
    const plane::Image baked =
        transfer_texture(mesh, now, {now, {0, 0}, images}, 64, 4, filled, Progress());
    Index colored = 0;
    for (std::size_t i = 0; i < baked.rgb.size(); i += 3)
        colored += baked.rgb[i] == 200 ? 1 : 0;
    EXPECT_EQ(baked.rgb.size(), 3U * 64 * 64);
    EXPECT_GE(colored, 38 * 38); // 32 pixels wide, and at least 3 on both sides
    EXPECT_LE(colored, 40 * 40);
    EXPECT_NEAR(filled, colored / (64.0 * 64.0), 1e-12);
}

TEST(TextureTransfer, FacesWithoutAnImageStayEmpty) {
    const Mesh mesh = checks::gated(shapes::grid(1, 1));
    const CornerUv now = of_points(mesh, {0.5, 0.5}, {0.5, 0.5}, 0.0);
    double filled = 1.0;
    transfer_texture(mesh, now, {now, {-1, 3}, {}}, 16, 2, filled, Progress());
    EXPECT_EQ(filled, 0.0);
}

TEST(Image, IsSampledBetweenPixelsAndRepeats) {
    const plane::Image two{2, 1, {0, 0, 0, 100, 100, 100}};
    EXPECT_NEAR(plane::sample(two, {0.25, 0.5})[0], 0.0, 1e-9);
    EXPECT_NEAR(plane::sample(two, {0.5, 0.5})[0], 50.0, 1e-9);
    EXPECT_NEAR(plane::sample(two, {0.75, 0.1})[0], 100.0, 1e-9);
    EXPECT_NEAR(plane::sample(two, {1.25, 7.5})[0], 0.0, 1e-9);
    EXPECT_NEAR(plane::sample(two, {-0.25, -3.0})[0], 100.0, 1e-9);
    const plane::Image column{1, 2, {10, 0, 0, 30, 0, 0}}; // the top row first
    EXPECT_NEAR(plane::sample(column, {0.5, 0.75})[0], 10.0, 1e-9);
}

} // namespace
} // namespace devseg::atlas
