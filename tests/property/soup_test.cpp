// Meshes of learned generators go the whole way to flat charts.
#include "property/soup.h"

#include <chrono>
#include <cstdlib>
#include <iostream>

#include <gtest/gtest.h>

#include "property/cases.h"
#include "unit/checks.h"
#include "unit/host_checks.h"

namespace devseg {
namespace {

using shapes::Random;

TEST(Soup, SharesOfCrowdedEdgesAreThoseOfGenerators) {
    Random random(1);
    double before = 0.0;
    for (const Index bubbles : {8, 60, 400}) {
        const double share = shapes::crowded_share(shapes::foam(random, 24, bubbles, 10));
        EXPECT_GT(share, before);
        before = share;
    }
    EXPECT_GT(shapes::crowded_share(shapes::foam(random, 24, 8, 10)), 0.03);
    EXPECT_LT(before, 0.4);
}

TEST(Soup, BecomesManifoldAndFlat) {
    checks::for_random_cases(3, [](Random& random) {
        const Index cells = 14 + random.below(8);
        const Index bubbles = 3 + random.below(300);
        const mesh::RawMesh raw = shapes::foam(random, cells, bubbles, random.below(40));
        SCOPED_TRACE(std::to_string(raw.faces.size()) + " faces, crowded " +
                     std::to_string(shapes::crowded_share(raw)));
        ASSERT_TRUE(checks::is_valid(mesh::gate_mesh(raw).mesh));
        declare::HostMesh host = checks::host_of(raw);
        checks::take_charts(host, checks::run("Segmentation: D-Charts", host));
        const declare::HostResult flat = checks::run("Charts: Flatten", host);
        checks::expect_complete(raw, flat);
        checks::expect_disks(raw, flat);
        checks::expect_valid_layout(raw, flat, true);
    });
}

// DEVSEG_SOUP_CELLS=40 DEVSEG_SOUP_BUBBLES=… tells the seconds of each stage.
TEST(Soup, TakesSeconds) {
    const char* cells = std::getenv("DEVSEG_SOUP_CELLS");
    const char* bubbles = std::getenv("DEVSEG_SOUP_BUBBLES");
    Random random(2);
    const mesh::RawMesh raw = shapes::foam(random, cells != nullptr ? std::atoi(cells) : 16,
                                           bubbles != nullptr ? std::atoi(bubbles) : 60, 30);
    std::cout << raw.faces.size() << " faces, crowded " << shapes::crowded_share(raw) << '\n';
    auto last = std::chrono::steady_clock::now();
    double total = 0.0;
    const auto tell = [&](const char* stage) {
        const auto now = std::chrono::steady_clock::now();
        const double seconds = std::chrono::duration<double>(now - last).count();
        std::cout << stage << ' ' << seconds << " s\n";
        total += seconds;
        last = std::chrono::steady_clock::now();
    };
    const mesh::GatedMesh gated = mesh::gate_mesh(raw);
    tell("gate");
    EXPECT_TRUE(checks::is_valid(gated.mesh));
    last = std::chrono::steady_clock::now();
    declare::HostMesh host = checks::host_of(raw);
    checks::take_charts(host, checks::run("Segmentation: D-Charts", host));
    tell("D-Charts");
    const declare::HostResult loose = checks::run("Charts: Flatten", host, {{"pack", false}});
    tell("flatten, side by side");
    declare::HostMesh packed = host;
    packed.wedge_uv = checks::run("Charts: Flatten", host).wedge_uv;
    tell("flatten and pack");
    std::cout << checks::value(loose, "charts_number") << " charts, packing "
              << checks::value(checks::run("Charts: Measure Flattening", packed),
                               "packing_efficiency")
              << "\n";
    EXPECT_LT(total, 60.0);
}

} // namespace
} // namespace devseg
