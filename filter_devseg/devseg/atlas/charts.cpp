#include "devseg/atlas/charts.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

namespace devseg::atlas {

namespace {

// One vertex for each fan of corners that hangs together across uncut edges.
void weld_corners(const Mesh& mesh, ChartSurface& surface) {
    for (const HalfEdge start : surface.all_half_edges()) {
        if (surface.origin(start) >= 0)
            continue;
        const Vertex v = surface.vertex_count();
        surface.vertex.push_back(mesh.origin(surface.mesh_half_edge(start)));
        mesh::visit_star(surface, start,
                         [&](HalfEdge h) { surface.faces[face_of(h)][corner_of(h)] = v; });
    }
}

// Boundary half-edges chained head to tail.
void trace_loops(ChartSurface& surface) {
    std::vector<std::uint8_t> done(surface.twin.size(), 0);
    for (const HalfEdge start : surface.all_half_edges()) {
        if (surface.twin[start] >= 0 || done[start] != 0)
            continue;
        std::vector<Index> loop;
        for (HalfEdge h = start; done[h] == 0; h = surface.next_on_boundary(h)) {
            done[h] = 1;
            loop.push_back(h);
        }
        surface.loops.push_back(std::move(loop));
    }
}

} // namespace

ChartMap make_chart_map(const Mesh& mesh, const std::vector<Index>& labels,
                        const std::vector<std::uint8_t>& seam, bool split_at_seams) {
    const auto is_cut = [&](HalfEdge h) { return !seam.empty() && seam[h] != 0; };
    const auto same_label = [&](HalfEdge h) {
        return labels[face_of(h)] == labels[mesh.across(h)];
    };
    mesh::FaceComponents parts = mesh::face_components(
        mesh, [&](HalfEdge h) { return same_label(h) && !(split_at_seams && is_cut(h)); });
    ChartMap result;
    result.chart = std::move(parts.label);
    result.count = parts.count;
    result.seam.assign(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge opposite = mesh.twin[h];
        if (opposite < 0)
            continue;
        const bool border = result.chart[face_of(h)] != result.chart[mesh.across(h)];
        result.seam[h] = border || is_cut(h) || is_cut(opposite) ? 1 : 0;
    }
    return result;
}

Buckets<Index> group_faces(const ChartMap& charts) {
    return make_buckets<Index>(charts.count, [&](auto put) {
        for (const Face f : Range<FaceKind>(0, static_cast<Index>(charts.chart.size())))
            put(charts.chart[f], f);
    });
}

namespace {

// `local_face` is scratch of size #F, valid for the given faces.
ChartSurface extract(const Mesh& mesh, std::vector<Index> faces,
                     const std::vector<std::uint8_t>& seam, std::vector<Index>& local_face) {
    ChartSurface surface;
    surface.face = std::move(faces);
    surface.faces.assign(surface.face.size(), Triangle{-1, -1, -1}); // until corners are welded
    for (const Face f : surface.all_faces())
        local_face[surface.face[f]] = f;
    surface.twin.assign(3 * surface.face.size(), -1);
    Index inner_half_edges = 0;
    for (const HalfEdge h : surface.all_half_edges()) {
        const HalfEdge global = surface.mesh_half_edge(h);
        const HalfEdge opposite = mesh.twin[global];
        if (opposite < 0 || seam[global] != 0)
            continue;
        surface.twin[h] = half_edge_of(local_face[face_of(opposite)], corner_of(opposite));
        ++inner_half_edges;
    }
    surface.edge_count = surface.half_edge_count() - inner_half_edges / 2;
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
    const Buckets<Index> groups = group_faces(charts);
    std::vector<Index> local_face(mesh.faces.size());
    std::vector<ChartSurface> surfaces;
    surfaces.reserve(at(charts.count));
    for (Index c = 0; c < charts.count; ++c)
        surfaces.push_back(
            extract(mesh, {groups[c].begin(), groups[c].end()}, charts.seam, local_face));
    return surfaces;
}

std::vector<std::uint8_t> enclose(const Mesh& mesh, const std::vector<Index>& faces,
                                  std::vector<std::uint8_t> seam) {
    std::vector<std::uint8_t> inside(mesh.faces.size(), 0);
    for (const Face f : faces)
        inside[f] = 1;
    for (const Face f : faces)
        for (const HalfEdge h : half_edges_of(f)) {
            const Face g = mesh.across(h);
            if (g >= 0 && inside[g] == 0)
                seam[h] = seam[mesh.twin[h]] = 1;
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
            const Face g = mesh.across(h);
            if (g >= 0 && in_b[g] != 0)
                seam[h] = seam[mesh.twin[h]] = 0;
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
            const Face g = mesh.across(h);
            if (g >= 0 && label[g] != label[f])
                border[label[g]] += mesh.edge_length(h);
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
    static_cast<mesh::Connectivity&>(part) = surface;
    for (const Vertex v : surface.vertex)
        part.points.push_back(mesh.points[v]);
    part.unit_length = mesh.unit_length;
    part.whole_area = mesh.model_area();
    mesh::compute_face_geometry(part);
    return part;
}

} // namespace devseg::atlas
