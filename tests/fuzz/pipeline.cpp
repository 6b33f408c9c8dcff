// A small mesh through a segmentation and a flattening; both results are validated.
#include <cmath>
#include <ctime>

#include <Eigen/Geometry>

#include "devseg/atlas/disks.h"
#include "devseg/base/errors.h"
#include "devseg/declare/filter.h"
#include "devseg/filters/table.h"
#include "devseg/flatten/flatten.h"
#include "devseg/flatten/repair/slits.h"
#include "devseg/flatten/repair/snap.h"
#include "devseg/metrics/parametrization.h"
#include "fuzz/bytes.h"

namespace devseg::fuzz {

namespace {

constexpr int most_vertices = 40;
constexpr int most_faces = 80;
constexpr double longest_run = 20.0; // seconds of a processor: machines that fuzz are busy

mesh::RawMesh read_mesh(Bytes& bytes) {
    mesh::RawMesh mesh;
    const int vertices = 1 + bytes.below(most_vertices);
    for (int v = 0; v < vertices; ++v) {
        const double x = bytes.number();
        const double y = bytes.number();
        mesh.points.emplace_back(x, y, bytes.number());
    }
    for (int f = bytes.below(most_faces); f > 0; --f) {
        // Faces beside the one before make surfaces, others make defects.
        const bool fan = !mesh.faces.empty() && bytes.flag();
        const auto any = [&] { return static_cast<Index>(bytes.below(vertices)); };
        const Triangle last = fan ? mesh.faces.back() : Triangle{any(), any(), 0};
        mesh.faces.push_back(fan ? Triangle{last[2], last[1], any()}
                                 : Triangle{last[0], last[1], any()});
    }
    return mesh;
}

Progress with_time_limit(const std::string& what) {
    return Progress([what, start = std::clock()](double, const char*) {
        if (static_cast<double>(std::clock() - start) > longest_run * CLOCKS_PER_SEC)
            fail(what + " takes too long");
        return true;
    });
}

atlas::ChartMap charts_of(const mesh::GatedMesh& gate, const declare::HostResult& segmented) {
    const Mesh& mesh = gate.mesh;
    std::vector<Index> labels;
    std::vector<std::uint8_t> seam;
    for (const Face f : mesh.all_faces()) {
        const std::size_t source = at(gate.source_face[f]);
        labels.push_back(segmented.chart_id[source]);
        for (Index e = 0; e < 3; ++e)
            seam.push_back(segmented.seam_edges[source] >> gate.source_edge(f, e) & 1);
    }
    return atlas::make_chart_map(mesh, labels, seam, true);
}

constexpr double least_visible = 1e-6; // internal units: models are about 1 long

struct Layout {
    CornerUv uv;
    Index charts = 0;
    Index too_thin = 0; // faces that rounding to 32 bit flattened
};

// What 'Charts: Flatten' does, but for its packing, which takes most of the time: charts in a row.
Layout lay_in_a_row(const Mesh& mesh, const atlas::ChartMap& charts,
                    flatten::FlattenMethod method) {
    Progress progress = with_time_limit("flattening");
    const atlas::DiskCuts disks = atlas::cut_charts_to_disks(mesh, charts, progress);
    flatten::FlattenResult flattened =
        flatten::flatten_charts(mesh, disks.charts, method, progress);
    Layout layout;
    layout.uv.assign(mesh.twin.size(), Vec2::Zero());
    double left = 0.0;
    for (flatten::FlatChart& chart : flattened.flat) {
        Eigen::AlignedBox2d box;
        for (const Vec2& p : chart.uv)
            box.extend(p);
        for (Vec2& p : chart.uv)
            p += Vec2(left, 0.0) - box.min();
        left += 1.01 * box.sizes().x() + 0.01;
        layout.too_thin += flatten::snap_to_single(chart.surface.faces, chart.uv);
        for (const HalfEdge h : chart.surface.all_half_edges())
            layout.uv[chart.surface.mesh_half_edge(h)] = chart.uv[chart.surface.origin(h)];
    }
    layout.charts = flattened.charts.count;
    return layout;
}

void run_pipeline(Bytes& bytes) {
    static const std::vector<const declare::FilterDeclaration*> methods = [] {
        std::vector<const declare::FilterDeclaration*> found;
        for (const declare::FilterDeclaration& filter : filters::filter_table())
            if (filter.menu_name.compare(0, 13, "Segmentation:") == 0)
                found.push_back(&filter);
        return found;
    }();
    const declare::FilterDeclaration& method =
        *methods[bytes.below(static_cast<int>(methods.size()))];
    const declare::ParameterValues charts{{"charts_number", 1 + bytes.below(6)},
                                          {"max_iterations", 5}};
    const auto way = static_cast<flatten::FlattenMethod>(bytes.below(5));
    declare::HostMesh host;
    host.geometry = read_mesh(bytes);
    declare::HostResult segmented;
    Progress progress = with_time_limit(method.menu_name);
    try {
        segmented = declare::run_filter(method, host, charts, progress);
    } catch (const InvalidMesh&) {
        return;
    } catch (const InvalidParameter&) {
        return;
    }
    // What could be segmented can be flattened.
    const mesh::GatedMesh gate = mesh::gate_mesh(host.geometry);
    const Layout layout = lay_in_a_row(gate.mesh, charts_of(gate, segmented), way);
    if (layout.too_thin > 0) // of which users are told: readers cannot see such charts
        return;
    // Nor where the sides of a cut are nearer to each other than 32 bits can tell on models that
    // are thousands of times as long as wide.
    if (flatten::slit_gap * std::sqrt(gate.mesh.total_area) < least_visible)
        return;
    const metrics::ParametrizationMeasures measured =
        metrics::measure_parametrization(gate.mesh, layout.uv);
    if (measured.flipped_faces_number != 0)
        fail("flipped faces");
    if (measured.overlapping_faces_number != 0)
        fail("overlapping faces");
    if (measured.charts_number != layout.charts)
        fail("charts that meet in the plane");
    if (measured.disk_charts_number != measured.charts_number)
        fail("a chart is no disk");
}

} // namespace

} // namespace devseg::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    devseg::fuzz::Bytes bytes(data, size);
    devseg::fuzz::run_pipeline(bytes);
    return 0;
}
