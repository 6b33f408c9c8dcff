// Charts: a label for each face, a mark for each cut edge, and one chart as a surface of its own.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/buckets.h"
#include "devseg/mesh/mesh.h"

namespace devseg::atlas {

/// A segmentation with its cuts. `seam` is symmetric: a half-edge and its twin agree. Edges
/// between two charts are always seams; further ones are darts, slits and cuts to a disk.
struct ChartMap {
    std::vector<Index> chart;       // #F, 0 … count − 1
    std::vector<std::uint8_t> seam; // 3 #F
    Index count = 0;
};

/// Labels → ChartMap: relabels so that every chart is edge-connected and the labels contiguous
/// (in the order of each chart's first face), and marks the edges between charts as seams.
/// `seam` (3 #F, may be empty) holds further cuts. A cut may not split a chart in two unless
/// `split_at_seams`: then it does, and the parts become charts.
ChartMap make_chart_map(const Mesh& mesh, const std::vector<Index>& labels,
                        const std::vector<std::uint8_t>& seam, bool split_at_seams);

/// The faces of each chart, ascending.
Buckets<Index> group_faces(const ChartMap& charts);

/// One chart, cut open along its seams: a manifold of its own, whose `faces` and `twin` are local
/// vertices and half-edges.
struct ChartSurface : mesh::Connectivity {
    std::vector<Index> face;               // #f: index in the mesh
    std::vector<Index> vertex;             // #v: index of the mesh vertex
    std::vector<std::vector<Index>> loops; // boundary loops as local half-edges, in their order
    Index edge_count = 0;

    Index vertex_count() const { return static_cast<Index>(vertex.size()); }
    Range<VertexKind> all_vertices() const { return {0, vertex_count()}; }
    Index euler_characteristic() const { return vertex_count() - edge_count + face_count(); }
    bool is_disk() const { return loops.size() == 1 && euler_characteristic() == 1; }
    /// Half-edge of the mesh that the local half-edge lies on.
    HalfEdge mesh_half_edge(HalfEdge h) const {
        return half_edge_of(face[face_of(h)], corner_of(h));
    }
};

/// The given faces, cut open along the marked edges (`seam`, 3 #F): all edges between these faces
/// and others must be marked.
ChartSurface extract_surface(const Mesh& mesh, std::vector<Index> faces,
                             const std::vector<std::uint8_t>& seam);

/// `seam` with the edges between the faces and others marked as well.
std::vector<std::uint8_t> enclose(const Mesh& mesh, const std::vector<Index>& faces,
                                  std::vector<std::uint8_t> seam);

/// The faces of two charts as one: the edges between them are no cuts any more, in `seam` (3 #F)
/// either.
ChartSurface join_surfaces(const Mesh& mesh, const ChartSurface& a, const ChartSurface& b,
                           std::vector<std::uint8_t>& seam);

/// Area of the faces, internal units squared.
double area_of(const Mesh& mesh, const ChartSurface& surface);

/// Other labels (#F) beside the faces of a chart, those with the longest common border first.
std::vector<Index> neighbour_labels(const Mesh& mesh, const std::vector<Index>& label,
                                    const ChartSurface& chart);

/// The same as extract_surface for each chart, in order of their labels.
std::vector<ChartSurface> extract_charts(const Mesh& mesh, const ChartMap& charts);

/// The surface as a mesh of its own, cut open along its seams; faces and vertices keep their order.
Mesh mesh_of(const Mesh& mesh, const ChartSurface& surface);

} // namespace devseg::atlas
