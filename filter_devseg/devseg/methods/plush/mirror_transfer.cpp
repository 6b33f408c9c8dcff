#include "devseg/methods/plush/mirror_transfer.h"

#include <set>
#include <utility>

#include "devseg/methods/plush/transfer_seams.h"

namespace devseg::plush {

namespace {

enum Zone : std::uint8_t { own, on_plane, image };

Zone zone_of(const WorkingSurface& surface, HalfEdge h) {
    return surface.is_on_plane(h) ? on_plane : surface.is_image(h) ? image : own;
}

std::vector<std::uint8_t> vertex_zones(const WorkingSurface& surface) {
    std::vector<std::uint8_t> zones(surface.mesh.points.size(), own);
    for (const HalfEdge h : surface.mesh.all_half_edges())
        if (surface.starts_on_plane(h))
            zones[surface.mesh.origin(h)] = on_plane;
        else if (surface.is_image(h))
            zones[surface.mesh.origin(h)] = image;
    return zones;
}

// An edge between two vertices, in either direction; −1 where there is none.
HalfEdge edge_between(const VertexGraph& graph, Vertex a, Vertex b) {
    for (Index i = graph.begin[a]; i < graph.begin[at(a) + 1]; ++i)
        if (graph.vertex[i] == b)
            return HalfEdge(graph.half_edge[i]);
    return HalfEdge(-1);
}

// Edges that were cut by the plane shrink to one of their ends. What a segment then runs along
// twice is a spur, and none of it.
SeamMarks own_half(const MirroredModel& mirrored, const SeamMarks& seam, const Mesh& model,
                   const VertexGraph& graph) {
    const Mesh& mesh = mirrored.surface.mesh;
    SeamMarks marks(model.twin.size(), 0);
    for (const SeamSegment& segment : find_segments(mesh, seam)) {
        std::set<Index> line;
        for (const HalfEdge h : segment.half_edges) {
            if (zone_of(mirrored.surface, h) == image)
                continue;
            const HalfEdge edge = edge_between(graph, Vertex(mirrored.place[mesh.origin(h)]),
                                               Vertex(mirrored.place[mesh.target(h)]));
            if (edge >= 0 && !line.insert(edge).second)
                line.erase(edge);
        }
        for (const Index h : line)
            mark(model, HalfEdge(h), 1, marks);
    }
    return marks;
}

} // namespace

SeamMarks seams_in_pairs(const WorkingSurface& from, const SeamMarks& seam,
                         const WorkingSurface& to, const VertexGraph& graph,
                         const std::vector<double>& factor, Progress& progress) {
    TransferZones zones;
    for (const HalfEdge h : from.mesh.all_half_edges()) {
        const Zone zone = zone_of(from, h);
        zones.line.push_back(zone == image ? TransferZones::left_out : zone);
    }
    zones.end = vertex_zones(from);
    zones.vertex = vertex_zones(to);
    SeamMarks marks =
        transfer_seams(from.mesh, seam, to.mesh, graph, factor, std::move(zones), progress);
    mirror_marks(to, marks);
    return marks;
}

SeamMarks seams_on_model(const MirroredModel& mirrored, const Mesh& placed, const SeamMarks& seam,
                         const Mesh& model, const VertexGraph& graph, Progress& progress) {
    TransferZones zones;
    for (const HalfEdge h : placed.all_half_edges()) {
        const Zone zone = zone_of(mirrored.surface, h);
        zones.line.push_back(zone == image ? zone : TransferZones::left_out);
    }
    zones.end.assign(placed.points.size(), image);
    zones.vertex.assign(model.points.size(), image);
    for (const Index v : mirrored.place)
        if (v >= 0)
            zones.vertex[v] = own;
    zones.place = mirrored.place;
    zones.seam = own_half(mirrored, seam, model, graph);
    zones.is_smooth = true;
    return transfer_seams(placed, seam, model, graph, std::vector<double>(model.twin.size(), 1.0),
                          std::move(zones), progress);
}

} // namespace devseg::plush
