// A small mesh through a segmentation and a flattening; both results are validated.
#include <cmath>
#include <ctime>
#include <utility>

#include "devseg/errors.h"
#include "devseg/filters/filter.h"
#include "fuzz/bytes.h"

namespace devseg::fuzz {

namespace {

constexpr int most_vertices = 40;
constexpr int most_faces = 80;
constexpr double longest_run = 20.0; // seconds of a processor: machines that fuzz are busy

RawMesh read_mesh(Bytes& bytes) {
    RawMesh mesh;
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

HostResult run(const FilterDeclaration& filter, const HostMesh& host,
               const ParameterValues& values) {
    const std::clock_t start = std::clock();
    Progress progress([&](double, const char*) {
        if (static_cast<double>(std::clock() - start) > longest_run * CLOCKS_PER_SEC)
            fail(filter.menu_name + " takes too long");
        return true;
    });
    return run_filter(filter, host, values, progress);
}

double value(const HostResult& result, const std::string& name) {
    for (const auto& [key, found] : result.values)
        if (key == name)
            return std::holds_alternative<int>(found) ? std::get<int>(found)
                                                      : std::get<double>(found);
    fail("no result " + name);
}

const FilterDeclaration& flattening() {
    for (const FilterDeclaration& filter : filter_table())
        if (filter.menu_name == "Charts: Flatten")
            return filter;
    fail("no flattening");
}

void run_pipeline(Bytes& bytes) {
    static const std::vector<const FilterDeclaration*> methods = [] {
        std::vector<const FilterDeclaration*> found;
        for (const FilterDeclaration& filter : filter_table())
            if (filter.menu_name.compare(0, 13, "Segmentation:") == 0)
                found.push_back(&filter);
        return found;
    }();
    const FilterDeclaration& method = *methods[at(bytes.below(static_cast<int>(methods.size())))];
    const ParameterValues charts{{"charts_number", 1 + bytes.below(6)}, {"max_iterations", 5}};
    const ParameterValues way{{"method", bytes.below(5)}, {"pack", false}};
    HostMesh host;
    host.geometry = read_mesh(bytes);
    HostResult segmented;
    try {
        segmented = run(method, host, charts);
    } catch (const InvalidMesh&) {
        return;
    } catch (const InvalidParameter&) {
        return;
    }
    host.chart_id.assign(segmented.chart_id.begin(), segmented.chart_id.end());
    host.seam_edges.assign(segmented.seam_edges.begin(), segmented.seam_edges.end());
    // What could be segmented can be flattened, unless it is too large for 32 bits.
    bool too_thin = false;
    try {
        HostResult flat = run(flattening(), host, way);
        host.wedge_uv = std::move(flat.wedge_uv);
        for (const std::string& note : flat.notes) // one face far larger than the others: told
            too_thin |= note.find("too thin for 32-bit") != std::string::npos;
    } catch (const InvalidMesh&) {
        return;
    }
    for (const FilterDeclaration& filter : filter_table()) {
        if (filter.python_name != "get_parametrization_measures")
            continue;
        const HostResult measured = run(filter, host, {});
        if (value(measured, "flipped_faces_number") != 0 && !too_thin)
            fail("flipped faces");
        if (value(measured, "overlapping_faces_number") != 0)
            fail("overlapping faces");
        if (value(measured, "disk_charts_number") != value(measured, "charts_number"))
            fail("a chart is no disk");
    }
}

} // namespace

} // namespace devseg::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    devseg::fuzz::Bytes bytes(data, size);
    devseg::fuzz::run_pipeline(bytes);
    return 0;
}
