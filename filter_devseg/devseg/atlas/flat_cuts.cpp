#include "devseg/atlas/flat_cuts.h"

#include <algorithm>
#include <utility>

#include "devseg/atlas/border_path.h"
#include "devseg/atlas/disks.h"
#include "devseg/atlas/join_loops.h"
#include "devseg/atlas/slit_closing.h"
#include "devseg/graph/unions.h"
#include "devseg/mesh/angle_defects.h"
#include "devseg/mesh/flat_regions.h"

namespace devseg::atlas {

namespace {

// Of the surface: smaller flat regions on fine meshes are chance.
constexpr double flat_share = 1e-3;

bool is_inner_cut(const Mesh& mesh, const ChartMap& charts, HalfEdge h) {
    return mesh.twin[h] > h && charts.seam[h] != 0 &&
           charts.chart[face_of(h)] == charts.chart[mesh.across(h)];
}

// By chart: the length of its cuts through flat faces, and what all of them cost.
std::vector<std::pair<double, double>>
costs_of_cuts(const Mesh& mesh, const std::vector<std::uint8_t>& within, const ChartMap& charts) {
    std::vector<std::pair<double, double>> costs(at(charts.count), {0.0, 0.0});
    for (const HalfEdge h : mesh.all_half_edges())
        if (is_inner_cut(mesh, charts, h)) {
            auto& [through, all] = costs[at(charts.chart[face_of(h)])];
            through += within[h] != 0 ? mesh.edge_length(h) : 0.0;
            all += cut_cost(mesh, h);
        }
    return costs;
}

// Without cuts through flat faces: loops and vertices may have no cut any more that need one.
ChartMap glued_over_flat_faces(const Mesh& mesh, const std::vector<std::uint8_t>& within,
                               const ChartMap& charts) {
    ChartMap glued = charts;
    for (const HalfEdge h : mesh.all_half_edges())
        if (within[h] != 0 && is_inner_cut(mesh, charts, h))
            glued.seam[h] = glued.seam[mesh.twin[h]] = 0;
    return glued;
}

// A forest of hinges between the parts of each chart, the longest edges first.
void hinge_parts(const Mesh& mesh, const std::vector<Index>& label,
                 std::vector<std::uint8_t>& seam) {
    const mesh::FaceComponents parts =
        mesh::face_components(mesh, [&](HalfEdge h) { return seam[h] == 0; });
    std::vector<std::pair<double, HalfEdge>> hinges;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] > h && label[face_of(h)] == label[mesh.across(h)] &&
            parts.label[face_of(h)] != parts.label[mesh.across(h)])
            hinges.emplace_back(-mesh.edge_length(h), h);
    std::sort(hinges.begin(), hinges.end());
    graph::Unions joined(at(parts.count));
    for (const auto& [length, h] : hinges) {
        const Index a = joined.find(parts.label[face_of(h)]);
        const Index b = joined.find(parts.label[mesh.across(h)]);
        if (a == b)
            continue;
        joined.join(a, b);
        seam[h] = seam[mesh.twin[h]] = 0;
    }
}

} // namespace

std::vector<std::uint8_t> within_flat_faces(const Mesh& mesh) {
    return mesh::within_flat_regions(mesh, flat_share);
}

std::vector<HoledFace> flat_faces_with_holes(const Mesh& mesh) {
    std::vector<HoledFace> found;
    for (std::vector<Index>& faces : mesh::flat_regions_with_holes(mesh, flat_share)) {
        const ChartSurface region = extract_surface(
            mesh, faces, enclose(mesh, faces, std::vector<std::uint8_t>(mesh.twin.size(), 0)));
        std::vector<std::pair<double, std::size_t>> loops; // by length
        for (std::size_t l = 0; l < region.loops.size(); ++l)
            loops.emplace_back(loop_length(mesh, region, region.loops[l]), l);
        std::sort(loops.begin(), loops.end());
        loops.pop_back();
        HoledFace face{std::move(faces), {}};
        for (const auto& [length, l] : loops)
            for (const HalfEdge h : region.loops[l])
                face.holes.push_back(region.mesh_half_edge(h));
        if (!face.holes.empty())
            found.push_back(std::move(face));
    }
    return found;
}

std::vector<std::uint8_t> rims_of_flat_faces(const Mesh& mesh) {
    std::vector<std::uint8_t> rims(mesh.twin.size(), 0);
    for (const HoledFace& face : flat_faces_with_holes(mesh))
        for (const HalfEdge h : face.holes)
            if (mesh.twin[h] >= 0)
                rims[h] = rims[mesh.twin[h]] = 1;
    const mesh::FaceComponents parts =
        mesh::face_components(mesh, [&](HalfEdge h) { return rims[h] == 0; });
    std::vector<double> area(at(parts.count), 0.0);
    for (const Face f : mesh.all_faces())
        area[parts.label[f]] += mesh.face_areas[f];
    const auto is_small = [&](Face f) {
        return area[parts.label[f]] < flat_share * mesh.total_area;
    };
    for (const HalfEdge h : mesh.all_half_edges())
        if (rims[h] != 0 && (is_small(face_of(h)) || is_small(mesh.across(h))))
            rims[h] = rims[mesh.twin[h]] = 0;
    return rims;
}

ChartMap keep_flat_faces_whole(const Mesh& mesh, const ChartMap& charts) {
    std::vector<Index> label = charts.chart;
    mesh::keep_regions_whole(mesh, flat_share, label);
    if (label == charts.chart)
        return charts;
    const mesh::FaceComponents regions = mesh::flat_regions(mesh);
    std::vector<std::uint8_t> seam = charts.seam;
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Face f = face_of(h);
        const Face g = mesh.across(h);
        const auto is_new = [&](Face face) { return label[face] != charts.chart[face]; };
        if (g >= 0 && (is_new(f) || is_new(g)))
            seam[h] = label[f] == label[g] && regions.label[f] == regions.label[g] ? 0 : 1;
    }
    hinge_parts(mesh, label, seam);
    return make_chart_map(mesh, label, seam, true);
}

void lead_around_flat_faces(const Mesh& mesh, const std::vector<double>& cost, double flat,
                            ChartMap& charts, Progress& progress) {
    const std::vector<std::uint8_t> within = within_flat_faces(mesh);
    ChartMap other = glued_over_flat_faces(mesh, within, charts);
    if (other.seam == charts.seam)
        return;
    const std::vector<std::uint8_t> boundary = mesh::boundary_vertices(mesh);
    const std::vector<Index> leaving = mesh::leaving_half_edges(mesh);
    const std::vector<Index> before = cut_edges_at_vertices(mesh, charts.seam);
    const Buckets<Index> groups = group_faces(charts);
    for (const Vertex v : mesh.all_vertices()) {
        if (before[v] == 0 || boundary[v] != 0 || !(cost[v] > flat))
            continue;
        bool is_open = false; // an earlier path may have come by
        mesh::visit_star(mesh, leaving[v],
                         [&](HalfEdge h) { is_open = is_open || other.seam[h] != 0; });
        if (is_open)
            continue;
        progress.check();
        const Span<Index> faces = groups[charts.chart[face_of(leaving[v])]];
        mark_cuts(mesh, path_to_border(mesh, {faces.begin(), faces.end()}, other.seam, v, within),
                  other.seam);
    }
    other = cut_charts_to_disks(mesh, other, progress).charts;
    const auto old_costs = costs_of_cuts(mesh, within, charts);
    const auto new_costs = costs_of_cuts(mesh, within, other);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const std::size_t c = at(charts.chart[face_of(h)]);
        if (new_costs[c] < old_costs[c])
            charts.seam[h] = other.seam[h];
    }
}

} // namespace devseg::atlas
