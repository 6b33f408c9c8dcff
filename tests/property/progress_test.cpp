// The bar of every filter stands where its work does. DEVSEG_PROGRESS_TRACE=1 prints where the time
// goes, to set the shares of parts by.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "property/cases.h"
#include "unit/host_checks.h"
#include "unit/shapes.h"
#include "unit/temporary_folder.h"

namespace devseg {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double nearly_done = 0.95; // of the bar
constexpr double most_left = 0.10;   // of the time, from there on
constexpr double too_short = 0.1;    // seconds: less is over before anybody has read the bar

struct Report {
    double fraction;
    std::string name;
    double wall;      // seconds from the start
    double processor; // seconds of all cores: on a busy machine, what the wall's clock hides
};

struct Times {
    std::vector<Report> reports;
    double wall = 0.0;
    double processor = 0.0;

    double wall_left(const Report& r) const { return 1.0 - r.wall / wall; }
    double processor_left(const Report& r) const { return 1.0 - r.processor / processor; }
};

class Watch {
public:
    double wall() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
    double processor() const { return static_cast<double>(std::clock() - clock_) / CLOCKS_PER_SEC; }

private:
    Clock::time_point start_ = Clock::now();
    std::clock_t clock_ = std::clock();
};

Times watch(const declare::FilterDeclaration& filter, const declare::HostMesh& host,
            const declare::ParameterValues& values, declare::HostResult& result) {
    Times times;
    const Watch watch;
    Progress progress([&](double fraction, const char* name) {
        times.reports.push_back({fraction, name, watch.wall(), watch.processor()});
        return true;
    });
    try {
        result = declare::run_filter(filter, host, values, progress);
    } catch (const InvalidMesh&) { // nothing is selected, or there is no texture
    }
    times.wall = watch.wall();
    times.processor = watch.processor();
    return times;
}

// A row for each name that the bar had: shares of the time beside shares of the bar.
std::string table_of(const Times& times) {
    std::string text;
    for (std::size_t i = 0, end = 0; i < times.reports.size(); i = end) {
        const Report& first = times.reports[i];
        for (end = i; end < times.reports.size() && times.reports[end].name == first.name;)
            ++end;
        const bool is_last = end == times.reports.size();
        char row[200];
        std::snprintf(row, sizeof row,
                      "  %-36s time %5.1f %% to %5.1f %%, bar %5.1f %% to %5.1f %%\n",
                      first.name.c_str(), 100.0 * (1.0 - times.wall_left(first)),
                      is_last ? 100.0 : 100.0 * (1.0 - times.wall_left(times.reports[end])),
                      100.0 * first.fraction,
                      100.0 * (is_last ? times.reports.back() : times.reports[end]).fraction);
        text += row;
    }
    return text;
}

void expect_true_bar(const std::string& what, const Times& times) {
    for (std::size_t i = 1; i < times.reports.size(); ++i)
        EXPECT_GE(times.reports[i].fraction, times.reports[i - 1].fraction) << what;
    const auto early = std::find_if(times.reports.begin(), times.reports.end(),
                                    [](const Report& r) { return r.fraction > nearly_done; });
    if (early == times.reports.end() || times.wall < too_short)
        return;
    EXPECT_LE(std::min(times.wall_left(*early), times.processor_left(*early)), most_left)
        << what << ": " << 100.0 * early->fraction << " % at " << early->name << '\n'
        << table_of(times);
}

// A body with four limbs, so that all stages of every method have something to do.
mesh::RawMesh body_with_limbs(Index subdivisions) {
    mesh::RawMesh raw = shapes::sphere(subdivisions);
    const Vec3 limbs[] = {{1.0, 0.6, 0.8}, {-1.0, 0.6, 0.8}, {1.0, -0.9, 0.3}, {-1.0, -0.9, 0.3}};
    for (Vec3& p : raw.points) {
        double length = 1.0;
        for (const Vec3& limb : limbs)
            length += 1.2 * std::exp(-12.0 * (p - limb.normalized()).squaredNorm());
        p *= length;
        p += 0.03 * Vec3(std::sin(7.0 * p.y()), 0.0, std::sin(5.0 * p.y()));
    }
    return raw;
}

// What a filter starts from: every kind of filter has seconds of work on it.
struct Start {
    declare::HostMesh plain;
    declare::HostMesh flat; // with charts and texture coordinates
};

Start make_start(Index subdivisions) {
    Start start{checks::host_of(body_with_limbs(subdivisions)), {}};
    start.flat = start.plain;
    checks::take_charts(start.flat, checks::run("Segmentation: D-Charts", start.flat));
    const declare::HostResult layout = checks::run("Charts: Flatten", start.flat);
    checks::take_charts(start.flat, layout);
    start.flat.wedge_uv = layout.wedge_uv;
    return start;
}

TEST(ProgressBar, IsNotAtItsEndWhileThereIsWork) {
    const TemporaryFolder folder;
    const Start small = make_start(4); // 5,120 faces
    const Start large = make_start(5); // 20,480 faces
    const std::map<std::string, const Start*> slow = {
        {"Segmentation: Plush Toy Seams", &small},
        {"Pattern: Optimize for Fabrication", &small},
    };
    const bool trace = std::getenv("DEVSEG_PROGRESS_TRACE") != nullptr;
    for (const declare::FilterDeclaration* filter : checks::filters_named("")) {
        declare::ParameterValues values;
        for (const declare::Parameter& parameter : filter->parameters)
            if (parameter.kind == declare::ParameterKind::output_file)
                values[parameter.name] = folder.file("pattern.pdf");
        const auto found = slow.find(filter->menu_name);
        const Start& start = found == slow.end() ? large : *found->second;
        const bool segments = filter->menu_name.find("Segmentation:") == 0;
        declare::HostResult result;
        const Times times = watch(*filter, segments ? start.plain : start.flat, values, result);
        if (trace)
            std::printf("%s: %.2f s\n%s", filter->menu_name.c_str(), times.wall,
                        table_of(times).c_str());
        expect_true_bar(filter->menu_name, times);
    }
}

} // namespace
} // namespace devseg
