#include "devseg/filters/sheet_layout.h"

#include <limits>

#include "devseg/base/errors.h"
#include "devseg/flatten/repair/snap.h"

namespace devseg::filters {

using namespace declare;

namespace {

std::vector<pack::PackItem> items_of(const std::vector<flatten::FlatChart>& charts) {
    std::vector<pack::PackItem> items;
    for (const flatten::FlatChart& chart : charts)
        items.push_back({&chart.surface.faces, &chart.uv});
    return items;
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
}

} // namespace devseg::filters
