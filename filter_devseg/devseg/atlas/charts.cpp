#include "devseg/atlas/charts.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

namespace devseg::atlas {

namespace {

// One vertex for each fan of corners that hangs together across uncut edges.
void weld_corners(const Mesh& mesh, ChartSurface& surface) {
    const Index corners = 3 * surface.face_count();
    surface.corners.assign(surface.face.size(), Triangle{-1, -1, -1});
    const auto corner = [&](HalfEdge h) -> Index& { return surface.corners[h / 3][h % 3]; };
    for (Index start = 0; start < corners; ++start) {
        if (corner(start) >= 0)
            continue;
        const Vertex v = surface.vertex_count();
        surface.vertex.push_back(mesh.origin(surface.mesh_half_edge(start)));
        for (HalfEdge h = start; h >= 0 && corner(h) < 0; h = surface.twin[Mesh::previous(h)])
            corner(h) = v;
        for (Index back = surface.twin[start]; back >= 0; back = surface.twin[Mesh::next(back)]) {
            if (corner(Mesh::next(back)) >= 0)
                break;
            corner(Mesh::next(back)) = v;
        }
    }
}

// Boundary half-edges chained head to tail; at its end, the next one is found by turning around
// the vertex inside the surface.
void trace_loops(ChartSurface& surface) {
    const Index half_edges = 3 * surface.face_count();
    std::vector<std::uint8_t> done(at(half_edges), 0);
    for (Index start = 0; start < half_edges; ++start) {
        if (surface.twin[start] >= 0 || done[start] != 0)
            continue;
        std::vector<Index> loop;
        for (HalfEdge h = start; done[h] == 0;) {
            done[h] = 1;
            loop.push_back(h);
            h = Mesh::next(h);
            while (surface.twin[h] >= 0)
                h = Mesh::next(surface.twin[h]);
        }
        surface.loops.push_back(std::move(loop));
    }
}

} // namespace

ChartMap make_chart_map(const Mesh& mesh, const std::vector<Index>& labels,
                        const std::vector<std::uint8_t>& seam, bool split_at_seams) {
    const auto is_cut = [&](HalfEdge h) { return !seam.empty() && seam[h] != 0; };
    const auto same_label = [&](HalfEdge h) { return labels[h / 3] == labels[mesh.twin[h] / 3]; };
    mesh::FaceComponents parts = mesh::face_components(
        mesh, [&](HalfEdge h) { return same_label(h) && !(split_at_seams && is_cut(h)); });
    ChartMap result;
    result.chart = std::move(parts.label);
    result.count = parts.count;
    result.seam.assign(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index opposite = mesh.twin[h];
        if (opposite < 0)
            continue;
        const bool border = result.chart[h / 3] != result.chart[opposite / 3];
        result.seam[h] = border || is_cut(h) || is_cut(opposite) ? 1 : 0;
    }
    return result;
}

ChartFaces group_faces(const ChartMap& charts) {
    ChartFaces result;
    result.begin.assign(at(charts.count) + 1, 0);
    for (const Index c : charts.chart)
        ++result.begin[at(c) + 1];
    std::partial_sum(result.begin.begin(), result.begin.end(), result.begin.begin());
    result.faces.resize(charts.chart.size());
    std::vector<Index> cursor(result.begin.begin(), result.begin.end() - 1);
    for (std::size_t f = 0; f < charts.chart.size(); ++f)
        result.faces[cursor[charts.chart[f]]++] = static_cast<Index>(f);
    return result;
}

namespace {

// `local_face` is scratch of size #F, valid for the given faces.
ChartSurface extract(const Mesh& mesh, std::vector<Index> faces,
                     const std::vector<std::uint8_t>& seam, std::vector<Index>& local_face) {
    ChartSurface surface;
    surface.face = std::move(faces);
    for (const Face f : surface.all_faces())
        local_face[surface.face[f]] = f;
    surface.twin.assign(3 * surface.face.size(), -1);
    Index inner_half_edges = 0;
    for (const HalfEdge h : surface.all_half_edges()) {
        const Index global = surface.mesh_half_edge(h);
        const Index opposite = mesh.twin[global];
        if (opposite < 0 || seam[global] != 0)
            continue;
        surface.twin[h] = 3 * local_face[opposite / 3] + opposite % 3;
        ++inner_half_edges;
    }
    surface.edge_count = 3 * surface.face_count() - inner_half_edges / 2;
    weld_corners(mesh, surface);
    trace_loops(surface);
    return surface;
}

} // namespace

ChartSurface extract_surface(const Mesh& mesh, std::vector<Index> faces,
                             const std::vector<std::uint8_t>& seam) {
    std::vector<Index> local_face(mesh.faces.size());
    return extract(mesh, std::move(faces), seam, local_face);
}

std::vector<ChartSurface> extract_charts(const Mesh& mesh, const ChartMap& charts) {
    const ChartFaces groups = group_faces(charts);
    std::vector<Index> local_face(mesh.faces.size());
    std::vector<ChartSurface> surfaces;
    surfaces.reserve(at(charts.count));
    for (Index c = 0; c < charts.count; ++c)
        surfaces.push_back(extract(mesh,
                                   {groups.faces.begin() + groups.begin[c],
                                    groups.faces.begin() + groups.begin[at(c) + 1]},
                                   charts.seam, local_face));
    return surfaces;
}

std::vector<std::uint8_t> enclose(const Mesh& mesh, const std::vector<Index>& faces,
                                  std::vector<std::uint8_t> seam) {
    std::vector<std::uint8_t> inside(mesh.faces.size(), 0);
    for (const Face f : faces)
        inside[f] = 1;
    for (const Face f : faces)
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge twin = mesh.twin[h];
            if (twin >= 0 && inside[twin / 3] == 0)
                seam[h] = seam[twin] = 1;
        }
    return seam;
}

ChartSurface join_surfaces(const Mesh& mesh, const ChartSurface& a, const ChartSurface& b,
                           std::vector<std::uint8_t>& seam) {
    std::vector<std::uint8_t> in_b(mesh.faces.size(), 0);
    for (const Face f : b.face)
        in_b[f] = 1;
    for (const Face f : a.face)
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge twin = mesh.twin[h];
            if (twin >= 0 && in_b[twin / 3] != 0)
                seam[h] = seam[twin] = 0;
        }
    std::vector<Index> faces;
    std::merge(a.face.begin(), a.face.end(), b.face.begin(), b.face.end(),
               std::back_inserter(faces));
    return extract_surface(mesh, std::move(faces), seam);
}

double area_of(const Mesh& mesh, const ChartSurface& surface) {
    double area = 0.0;
    for (const Face f : surface.face)
        area += mesh.face_areas[f];
    return area;
}

std::vector<Index> neighbour_labels(const Mesh& mesh, const std::vector<Index>& label,
                                    const ChartSurface& chart) {
    std::map<Index, double> border;
    for (const Face f : chart.face)
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge twin = mesh.twin[h];
            if (twin >= 0 && label[twin / 3] != label[f])
                border[label[twin / 3]] += mesh.edge_length(h);
        }
    std::vector<std::pair<double, Index>> order;
    for (const auto& [other, length] : border)
        order.emplace_back(-length, other);
    std::sort(order.begin(), order.end());
    std::vector<Index> labels;
    for (const auto& entry : order)
        labels.push_back(entry.second);
    return labels;
}

Mesh mesh_of(const Mesh& mesh, const ChartSurface& surface) {
    Mesh part;
    for (const Vertex v : surface.vertex)
        part.points.push_back(mesh.points[v]);
    part.faces = surface.corners;
    part.twin = surface.twin;
    part.unit_length = mesh.unit_length;
    mesh::compute_face_geometry(part);
    return part;
}

} // namespace devseg::atlas
