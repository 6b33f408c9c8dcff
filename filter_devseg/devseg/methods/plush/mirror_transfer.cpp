#include "devseg/methods/plush/mirror_transfer.h"

#include <set>
#include <utility>

#include "devseg/methods/plush/transfer_seams.h"

namespace devseg::plush {

namespace {

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
            if (mirrored.surface.is_image(h))
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

SeamMarks seams_on_model(const MirroredModel& mirrored, const Mesh& placed, const SeamMarks& seam,
                         const Mesh& model, const VertexGraph& graph, Progress& progress) {
    TransferRest rest;
    for (const HalfEdge h : placed.all_half_edges())
        rest.edges.push_back(mirrored.surface.is_image(h) ? 0 : 1);
    rest.closed.assign(model.points.size(), 0);
    for (const Index v : mirrored.place)
        if (v >= 0)
            rest.closed[at(v)] = 1;
    rest.place = mirrored.place;
    rest.seam = own_half(mirrored, seam, model, graph);
    rest.is_smooth = true;
    return transfer_seams(placed, seam, model, graph, std::vector<double>(model.twin.size(), 1.0),
                          std::move(rest), progress);
}

} // namespace devseg::plush
