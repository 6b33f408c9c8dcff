// Every filter can be cancelled at any time, and says so soon. DEVSEG_CANCEL_FACES makes the mesh
// larger: the time holds for a million faces. DEVSEG_CANCEL_FIRST and DEVSEG_CANCEL_SECONDS bound
// when the first and the last click come.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <thread>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "property/cases.h"
#include "unit/host_checks.h"
#include "unit/shapes.h"
#include "unit/temporary_folder.h"

namespace devseg {
namespace {

using Clock = std::chrono::steady_clock;
using checks::filters_named;

constexpr double longest_wait = 0.1; // seconds

double from_environment(const char* name, double otherwise) {
    const char* text = std::getenv(name);
    return text == nullptr ? otherwise : std::atof(text);
}

// A torus with bumps: handles, charts of all sizes, darts.
mesh::RawMesh bumpy_torus(Index faces) {
    const auto tube = static_cast<Index>(std::sqrt(faces / 4.0));
    mesh::RawMesh raw = shapes::torus(2 * tube, tube);
    for (Vec3& p : raw.points)
        p += 0.08 * Vec3(std::sin(7.0 * p.y()), std::sin(6.0 * p.z()), std::sin(5.0 * p.x()));
    return raw;
}

struct Stop {
    bool in_time = false;   // the click came before the end
    double wall = 0.0;      // seconds from the user's click to the end of the filter
    double processor = 0.0; // seconds of one core in that time: on a busy machine, less
};

double processor_time() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

// Clicks "cancel" after `delay` seconds of processor time.
Stop cancel_after(double delay, const declare::FilterDeclaration& filter,
                  const declare::HostMesh& host, const declare::ParameterValues& values,
                  std::string& phase) {
    std::atomic<bool> stop{false};
    std::atomic<bool> ended{false};
    const double start = processor_time();
    double clicked_at = 0.0;
    Clock::time_point clicked;
    std::thread user([&] {
        while (!ended && processor_time() - start < delay)
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        clicked = Clock::now();
        clicked_at = processor_time();
        stop = true;
    });
    Progress progress([&](double, const char* name) {
        phase = name;
        return !stop;
    });
    Stop result;
    try {
        declare::run_filter(filter, host, values, progress);
    } catch (const Cancelled&) {
        EXPECT_TRUE(stop);
    } catch (const NumericalFailure&) { // what it asks for may be out of reach: an end as well
    } catch (const InvalidMesh&) {      // nothing is selected, or there is no texture
    } catch (const InvalidParameter&) { // what is selected cannot be joined
    }
    const Clock::time_point end = Clock::now();
    const double end_at = processor_time();
    ended = true;
    user.join();
    result.in_time = clicked < end;
    result.wall = std::chrono::duration<double>(end - clicked).count();
    result.processor = end_at - clicked_at;
    return result;
}

struct Work {
    const declare::FilterDeclaration* filter;
    declare::ParameterValues values;
};

std::vector<Work> all_work(const std::string& file) {
    std::vector<Work> all;
    for (const declare::FilterDeclaration* filter : filters_named("")) {
        declare::ParameterValues values;
        for (const declare::Parameter& parameter : filter->parameters)
            if (parameter.kind == declare::ParameterKind::output_file)
                values[parameter.name] = file;
        all.push_back({filter, values});
        for (const declare::Parameter& parameter : filter->parameters)
            if (parameter.name == "method")
                for (int i = 1; i < static_cast<int>(parameter.choices.size()); ++i) {
                    values["method"] = i;
                    all.push_back({filter, values});
                }
    }
    return all;
}

TEST(Cancel, EveryFilterStopsSoonAndLeavesNoFile) {
    const TemporaryFolder folder;
    const auto faces = static_cast<Index>(from_environment("DEVSEG_CANCEL_FACES", 8000.0));
    const double first_click = from_environment("DEVSEG_CANCEL_FIRST", 0.001);
    const double latest_click = from_environment("DEVSEG_CANCEL_SECONDS", 1e6);
    declare::HostMesh segmented = checks::host_of(bumpy_torus(faces));
    checks::take_charts(segmented, checks::run("Segmentation: D-Charts", segmented));
    declare::HostMesh flat = segmented;
    const declare::HostResult layout = checks::run("Charts: Flatten", flat);
    checks::take_charts(flat, layout);
    flat.wedge_uv = layout.wedge_uv;
    shapes::Random random(7);
    const char* chosen = std::getenv("DEVSEG_CANCEL_FILTER"); // part of a name
    const std::string only = chosen == nullptr ? "" : chosen;
    double worst = 0.0;
    for (const auto& [filter, values] : all_work(folder.file("pattern.pdf"))) {
        if (filter->menu_name.find(only) == std::string::npos)
            continue;
        const bool needs_layout = filter->needs_uv;
        const bool segments = filter->menu_name.find("Segmentation:") == 0;
        // Flattening starts from charts, and once from none: then one large chart is cut.
        for (const bool charted : {true, false}) {
            if ((needs_layout || segments) && !charted)
                continue;
            const declare::HostMesh& host = needs_layout ? flat
                                            : charted    ? segmented
                                                         : checks::host_of(segmented.geometry);
            double delay = first_click;
            for (int i = 0; i < 200 && delay < latest_click; ++i) {
                std::string phase;
                const Stop stop = cancel_after(delay, *filter, host, values, phase);
                if (!stop.in_time)
                    break; // it was faster
                const double wait = std::min(stop.wall, stop.processor);
                if (wait > worst || wait > longest_wait)
                    std::cout << checks::described(*filter, values)
                              << (charted ? "" : " (no charts)") << ", phase " << phase << " after "
                              << delay << " s: " << stop.wall << " s, processor " << stop.processor
                              << " s\n";
                worst = std::max(worst, wait);
                EXPECT_LE(wait, 2.0 * longest_wait)
                    << checks::described(*filter, values) << ", phase " << phase << " after "
                    << delay << " s";
                delay *= random.uniform(1.1, 2.2);
            }
        }
    }
    std::filesystem::remove(folder.file("pattern.pdf"));
    EXPECT_EQ(folder.count(), 0) << "something beside the file";
}

} // namespace
} // namespace devseg
