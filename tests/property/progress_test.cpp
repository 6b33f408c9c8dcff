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
            const declare::ParameterValues& values) {
    Times times;
    const Watch watch;
    Progress progress([&](double fraction, const char* name) {
        times.reports.push_back({fraction, name, watch.wall(), watch.processor()});
        return true;
    });
    declare::run_filter(filter, host, values, progress);
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

void flatten(declare::HostMesh& host) {
    const declare::HostResult layout = checks::run("Charts: Flatten", host);
    checks::take_charts(host, layout);
    host.wedge_uv = layout.wedge_uv;
}

Start make_start(Index subdivisions) {
    Start start{checks::host_of(body_with_limbs(subdivisions)), {}};
    start.flat = start.plain;
    const declare::HostResult charts = checks::run("Segmentation: D-Charts", start.flat);
    checks::take_charts(start.flat, charts);
    start.flat.face_color = charts.face_color;
    flatten(start.flat);
    return start;
}

// A chart in each octant, with a colour of its own: soon made on very many faces.
Start make_octants(Index subdivisions) {
    Start start{checks::host_of(body_with_limbs(subdivisions)), {}};
    start.flat = start.plain;
    const mesh::RawMesh& raw = start.flat.geometry;
    for (const auto& [a, b, c] : raw.faces) {
        const Vec3 sum = raw.points[a] + raw.points[b] + raw.points[c];
        const int octant = (sum.x() > 0.0) + 2 * (sum.y() > 0.0) + 4 * (sum.z() > 0.0);
        start.flat.chart_id.push_back(octant);
        start.flat.face_color.push_back({static_cast<std::uint8_t>(30 * octant), 80, 160});
    }
    start.flat.seam_edges.assign(raw.faces.size(), 0.0);
    flatten(start.flat);
    return start;
}

// Two charts that lie side by side, all seams, and the tip of a limb that no seam runs through.
void select(declare::HostMesh& host) {
    const std::vector<double>& chart = host.chart_id;
    const checks::Edges edges = checks::edges_of(host.geometry);
    const auto between = std::find_if(edges.begin(), edges.end(), [&](const auto& edge) {
        const auto& sides = edge.second;
        return sides.size() == 2 && chart[sides[0].first] != chart[sides[1].first];
    });
    ASSERT_NE(between, edges.end());
    for (const double c : chart)
        host.face_selected.push_back(c == chart[between->second[0].first] ||
                                     c == chart[between->second[1].first]);
    host.edge_selected.assign(host.seam_edges.begin(), host.seam_edges.end());
    const std::vector<Vec3>& points = host.geometry.points;
    std::vector<double> reach(points.size()); // 0 on seams
    std::transform(points.begin(), points.end(), reach.begin(),
                   [](const Vec3& p) { return p.norm(); });
    for (const auto& [ends, sides] : edges)
        for (const auto& [face, k] : sides)
            if ((static_cast<int>(host.seam_edges[face]) >> k & 1) != 0)
                for (const Index v : ends)
                    reach[at(v)] = 0.0;
    host.vertex_selected.assign(points.size(), 0);
    const auto tip = std::max_element(reach.begin(), reach.end()) - reach.begin();
    host.vertex_selected[static_cast<std::size_t>(tip)] = 1;
}

// An image with other colours everywhere, on the layout that there is.
void paint(declare::HostMesh& host) {
    plane::Image image{512, 512, {}};
    for (int i = 0; i < 3 * image.width * image.height; ++i)
        image.rgb.push_back(static_cast<std::uint8_t>(i * 7 % 251));
    host.textures = {image};
    host.uv_before = host.wedge_uv;
    host.page_before.assign(host.wedge_uv.size(), 0);
}

declare::HostMesh host_for(const declare::FilterDeclaration& filter, const Start& start) {
    if (filter.menu_name.find("Segmentation:") == 0)
        return start.plain;
    declare::HostMesh host = start.flat;
    if (filter.needs_selection)
        select(host);
    if (filter.needs_texture)
        paint(host);
    return host;
}

TEST(ProgressBar, IsNotAtItsEndWhileThereIsWork) {
    const TemporaryFolder folder;
    const Start small = make_start(4);  // 5,120 faces
    const Start large = make_start(6);  // 81,920 faces
    const Start huge = make_octants(7); // 327,680 faces
    const std::map<std::string, const Start*> others = {
        {"Segmentation: Plush Toy Seams", &small},
        {"Charts: Deform to Exact Developability", &small},
        {"Charts: From Selected Edges", &huge},
        {"Charts: Cut to Disks", &huge},
        {"Charts: From Texture Coordinates", &huge},
        {"Charts: From Colors or Materials", &huge},
        {"Charts: Cut Mesh Along Seams", &huge},
        {"Charts: Colorize", &huge},
        {"Charts: Measure Segmentation", &huge},
        {"Charts: Measure Flattening", &huge},
        {"Charts: Measure Maps to the Circle", &huge},
        {"Pattern: Optimize for Fabrication", &huge},
        {"Pattern: Generate Pieces", &huge},
        {"Pattern: Measure", &huge},
    };
    const bool trace = std::getenv("DEVSEG_PROGRESS_TRACE") != nullptr;
    for (const declare::FilterDeclaration* filter : checks::filters_named("")) {
        declare::ParameterValues values;
        for (const declare::Parameter& parameter : filter->parameters) {
            if (parameter.kind == declare::ParameterKind::output_file)
                values[parameter.name] = folder.file("pattern.pdf");
            if (parameter.name == "force") // the work is done, whatever comes of it
                values[parameter.name] = true;
        }
        const auto found = others.find(filter->menu_name);
        const Start& start = found == others.end() ? large : *found->second;
        const Times times = watch(*filter, host_for(*filter, start), values);
        if (trace)
            std::printf("%s: %.2f s\n%s", filter->menu_name.c_str(), times.wall,
                        table_of(times).c_str());
        expect_true_bar(filter->menu_name, times);
    }
}

} // namespace
} // namespace devseg
