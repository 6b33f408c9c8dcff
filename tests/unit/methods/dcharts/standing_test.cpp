// Charts above their bounds are named, whatever the reason.
#include "devseg/methods/dcharts/standing.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/host_checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::dcharts {
namespace {

using checks::run;
using checks::value;
using declare::HostResult;

bool keeps_bounds(const HostResult& result) {
    for (const auto& [name, v] : result.values)
        if (name == "bounds_kept")
            return std::get<bool>(v);
    ADD_FAILURE();
    return false;
}

TEST(Standing, AChartStandsAsTheWorstOfItsFaces) {
    const atlas::ChartMap charts{{0, 0, 1, 1, 2}, {}, 3};
    const ChartsAbove above =
        charts_above(charts, {Standing::kept, Standing::rough, Standing::rough, Standing::above,
                              Standing::kept});
    EXPECT_EQ(above.chart, (std::vector<std::uint8_t>{1, 1, 0}));
    EXPECT_EQ(above.count, 2);
    EXPECT_EQ(above.rough, 1);
}

// Noise of half an edge: small neighbourhoods stretch by more than the bound.
TEST(Standing, RoughChartsAreCountedToldAndSelected) {
    const auto host = checks::host_of(shapes::with_noise(shapes::cylinder_tube(100, 50), 0.04, 7));
    const HostResult r =
        run("Segmentation: D-Charts", host, {{"merge_charts", false}, {"add_darts", false}});
    const double above = value(r, "charts_above_bound_number");
    EXPECT_GT(above, 0);
    EXPECT_GT(value(r, "rough_charts_number"), 0);
    EXPECT_FALSE(keeps_bounds(r));
    ASSERT_EQ(r.face_selected.size(), r.chart_id.size());
    std::vector<int> chosen;
    for (std::size_t f = 0; f < r.chart_id.size(); ++f)
        if (r.face_selected[f] != 0)
            chosen.push_back(r.chart_id[f]);
    std::sort(chosen.begin(), chosen.end());
    chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
    EXPECT_EQ(static_cast<double>(chosen.size()), above);
    EXPECT_TRUE(std::any_of(r.notes.begin(), r.notes.end(), [](const std::string& note) {
        return checks::contains(note, "rough");
    }));
}

TEST(Standing, WhereAllIsKeptTheSelectionStays) {
    const HostResult r = run("Segmentation: D-Charts", checks::host_of(shapes::sphere(3)));
    EXPECT_EQ(value(r, "charts_above_bound_number"), 0);
    EXPECT_TRUE(keeps_bounds(r));
    EXPECT_TRUE(r.face_selected.empty());
}

} // namespace
} // namespace devseg::dcharts
