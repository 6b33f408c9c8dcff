#include "devseg/filters/sheet_layout.h"

#include <cmath>
#include <limits>

#include "devseg/base/errors.h"
#include "devseg/flatten/repair/snap.h"
#include "devseg/plane/plane.h"

namespace devseg::filters {

using namespace declare;

namespace {

std::vector<pack::PackItem> items_of(const std::vector<flatten::FlatChart>& charts) {
    std::vector<pack::PackItem> items;
    for (const flatten::FlatChart& chart : charts)
        items.push_back({&chart.surface.faces, &chart.uv});
    return items;
}

// Charts whose width is fewer steps of 32-bit numbers than this: rounding changes it by more than a
// few percent.
constexpr double fewest_steps = 25.0;

bool is_too_thin(const flatten::FlatChart& chart) {
    double area = 0.0;
    for (const Triangle& t : chart.surface.faces)
        area += plane::triangle_area(chart.uv[t[0]], chart.uv[t[1]], chart.uv[t[2]]);
    double farthest = 0.0;
    for (const Vec2& p : chart.uv)
        farthest = std::max(farthest, p.cwiseAbs().maxCoeff());
    const double width = area / plane::box_of(chart.uv).diagonal().norm();
    return !(width >= fewest_steps * std::numeric_limits<float>::epsilon() * farthest);
}

SheetLayout place(const Mesh& mesh, std::vector<flatten::FlatChart>& charts,
                  const pack::PackResult& packed, double scale_to_side) {
    const double scale = scale_to_side > 0.0 ? scale_to_side / packed.side : mesh.unit_length;
    if (!(scale * packed.side < std::numeric_limits<float>::max()))
        throw InvalidMesh("expected a model small enough for 32-bit texture coordinates in its own "
                          "units, found a larger one; scale it down, or pack into the unit square");
    SheetLayout layout;
    layout.uv.assign(mesh.twin.size(), Vec2::Zero());
    for (std::size_t c = 0; c < charts.size(); ++c) {
        flatten::FlatChart& chart = charts[c];
        for (Vec2& p : chart.uv)
            p = scale * packed.placements[c](p);
        if (is_too_thin(chart)) {
            ++layout.thin;
            layout.look.resize(mesh.faces.size(), 0);
            for (const Face f : chart.surface.face)
                layout.look[f] = 1;
        }
        layout.unsettled += flatten::snap_to_single(chart.surface.faces, chart.uv);
        for (const HalfEdge h : chart.surface.all_half_edges())
            layout.uv[chart.surface.mesh_half_edge(h)] = chart.uv[chart.surface.origin(h)];
    }
    return layout;
}

} // namespace

SheetLayout lay_out(const Mesh& mesh, std::vector<flatten::FlatChart>& charts,
                    const pack::PackOptions& options, double scale_to_side, Progress& progress) {
    return place(mesh, charts, pack::pack_charts(items_of(charts), options, progress),
                 scale_to_side);
}

SheetLayout lay_out_in_rows(const Mesh& mesh, std::vector<flatten::FlatChart>& charts) {
    return place(mesh, charts, pack::pack_rows(items_of(charts), pack::PackOptions().padding), 0.0);
}

std::vector<std::string> effort_names() {
    return {"Fast", "Normal", "Best"};
}

pack::PackOptions packing_with(pack::PackEffort effort) {
    pack::PackOptions options;
    options.effort = effort;
    return options;
}

void note_unsettled(const SheetLayout& layout, FilterOutput& output) {
    if (layout.unsettled > 0)
        output.notes.push_back(std::to_string(layout.unsettled) +
                               " faces are too thin for 32-bit texture coordinates and lost their "
                               "area in the plane");
    if (layout.thin > 0)
        output.notes.push_back(std::to_string(layout.thin) +
                               " charts are too thin for 32-bit texture coordinates, which stretch "
                               "them; their faces are selected");
    output.selected = layout.look;
}

} // namespace devseg::filters
