// Given charts brought within their bounds.
#include "devseg/methods/dcharts/refine.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/shapes.h"

namespace devseg::dcharts {
namespace {

using checks::run;
using checks::value;
using declare::HostMesh;
using declare::HostResult;

// The whole ball is one chart.
HostMesh ball() {
    return checks::host_of(shapes::sphere(3));
}

double worst_chart(const HostMesh& host, const HostResult& charts) {
    HostMesh laid = host;
    checks::take_charts(laid, charts);
    const HostResult flat = run("Charts: Flatten", laid, {{"pack", false}});
    EXPECT_EQ(value(flat, "charts_number"), value(charts, "charts_number"));
    laid.wedge_uv = flat.wedge_uv;
    checks::take_charts(laid, flat);
    const HostResult measured = run("Charts: Measure Flattening", laid);
    for (const auto& [name, v] : measured.values)
        if (name == "chart_l2_stretch") {
            const auto& all = std::get<std::vector<double>>(v);
            return *std::max_element(all.begin(), all.end());
        }
    ADD_FAILURE();
    return 0.0;
}

TEST(Refine, ChartsAboveTheirBoundAreTakenDown) {
    const HostMesh host = ball();
    for (const double bound : {1.05, 1.02}) {
        const HostResult r = run("Charts: Refine", host, {{"max_chart_l2_stretch", bound}});
        EXPECT_EQ(value(r, "charts_before_number"), 1);
        EXPECT_GT(value(r, "charts_number"), 1);
        EXPECT_EQ(value(r, "charts_above_bound_number"), 0);
        EXPECT_LE(worst_chart(host, r), bound);
        checks::expect_agreement(host.geometry, r);
    }
}

TEST(Refine, ChartsWithinTheirBoundStay) {
    HostMesh host = checks::host_of(shapes::cylinder_tube(24, 8));
    for (const Triangle& t : host.geometry.faces) {
        const Vec3 p =
            host.geometry.points[t[0]] + host.geometry.points[t[1]] + host.geometry.points[t[2]];
        host.chart_id.push_back(std::floor((std::atan2(p.y(), p.x()) + pi) / (0.5 * pi)));
    }
    const HostResult r = run("Charts: Refine", host);
    EXPECT_EQ(value(r, "charts_number"), 4);
    EXPECT_EQ(value(r, "darts_number"), 0);
    const HostResult joined = run("Charts: Refine", host, {{"merge_charts", true}});
    EXPECT_EQ(value(joined, "charts_number"), 1);
    EXPECT_NEAR(worst_chart(host, joined), 1.0, 1e-6);
}

TEST(Refine, KeptSeamsStay) {
    HostMesh host = ball();
    for (const Triangle& t : host.geometry.faces) {
        const Vec3 p =
            host.geometry.points[t[0]] + host.geometry.points[t[1]] + host.geometry.points[t[2]];
        host.chart_id.push_back(p.x() > 0.1 * std::sin(7.0 * p.y()) ? 1.0 : 0.0);
        host.seam_edges.push_back(0.0);
    }
    const HostResult r = run("Charts: Refine", host, {{"keep", 1}, {"merge_charts", true}});
    std::map<int, double> old; // each chart lies in one that was given
    for (std::size_t f = 0; f < r.chart_id.size(); ++f) {
        const auto [place, fresh] = old.emplace(r.chart_id[f], host.chart_id[f]);
        ASSERT_EQ(place->second, host.chart_id[f]);
    }
    EXPECT_LE(worst_chart(host, r), 1.02);
}

TEST(Refine, BoundsOfOneOrLessAreRefused) {
    for (const char* name : {"max_chart_l2_stretch", "max_l2_stretch", "max_linf_stretch"})
        EXPECT_THROW(run("Charts: Refine", ball(), {{name, 0.9}}), InvalidParameter);
}

} // namespace
} // namespace devseg::dcharts
