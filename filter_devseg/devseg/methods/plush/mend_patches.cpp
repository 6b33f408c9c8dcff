#include "devseg/methods/plush/mend_patches.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/base/parallel.h"
#include "devseg/mesh/surface_search.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

// The inner vertex where the map shrinks most; −1 where nothing lies inside.
Vertex shrunk_vertex(const Mesh& mesh, const judge::ClothTrial& map,
                     const std::vector<std::uint8_t>& on_border) {
    std::vector<double> area(mesh.points.size(), 0.0);
    std::vector<double> flat_area(mesh.points.size(), 0.0);
    for (std::size_t i = 0; i < map.face.size(); ++i)
        for (const Vertex v : mesh.faces[map.face[i]]) {
            area[v] += mesh.face_areas[map.face[i]];
            flat_area[v] += mesh.face_areas[map.face[i]] * (1.0 + map.change[i]);
        }
    Vertex least;
    for (const Vertex v : mesh.all_vertices())
        if (area[v] > 0.0 && on_border[v] == 0 &&
            (least < 0 || flat_area[v] * area[least] < flat_area[least] * area[v]))
            least = v;
    return least;
}

// From the vertex that shrinks most to the nearest one on the border.
std::vector<Index> find_dart(const Mesh& mesh, const VertexGraph& graph,
                             const std::vector<double>& cost, const std::vector<Index>& patch,
                             const SeamMarks& seam, const Progress& progress) {
    std::vector<std::uint8_t> inside(mesh.points.size(), 0);
    std::vector<std::uint8_t> on_border(mesh.points.size(), 0);
    for (const Face f : patch)
        for (const HalfEdge h : half_edges_of(f)) {
            inside[mesh.origin(h)] = 1;
            if (is_border(mesh, seam, h))
                on_border[mesh.origin(h)] = on_border[mesh.target(h)] = 1;
        }
    const Vertex tip = shrunk_vertex(mesh, judge::conformal_change(mesh, patch, seam), on_border);
    if (tip < 0)
        return {};
    const PathTree tree = shortest_paths(graph, cost, {tip}, progress, inside, on_border);
    Vertex end;
    for (const Vertex v : mesh.all_vertices())
        if (on_border[v] != 0 && std::isfinite(tree.distance[v]) &&
            (end < 0 || tree.distance[v] < tree.distance[end]))
            end = v;
    return end < 0 ? std::vector<Index>{} : trace_path(mesh, tree, end);
}

// Darts that ended on a border that is open now, from one side or the other.
void open_what_floats(const Mesh& mesh, const SeamMarks& hard, const std::vector<Index>& faces,
                      SeamMarks& marks) {
    std::vector<std::uint8_t> inside(mesh.faces.size(), 0);
    for (const Face f : faces)
        inside[f] = 1;
    std::vector<Index> inner; // half-edges of cuts
    std::vector<std::uint8_t> is_tied(mesh.points.size(), 0);
    for (const Face f : faces)
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge twin = mesh.twin[h];
            if (twin < 0 || inside[face_of(twin)] == 0)
                is_tied[mesh.origin(h)] = is_tied[mesh.target(h)] = 1;
            else if (marks[h] != 0)
                inner.push_back(h);
        }
    for (bool grows = true; grows;) {
        grows = false;
        for (const HalfEdge h : inner)
            if (is_tied[mesh.origin(h)] != 0 && is_tied[mesh.target(h)] == 0)
                is_tied[mesh.target(h)] = grows = true;
    }
    for (const HalfEdge h : inner)
        if (is_tied[mesh.origin(h)] == 0 && !is_marked(hard, h))
            mark(mesh, h, 0, marks);
}

// The patches up to a share of the surface, the smallest first.
std::vector<std::pair<double, std::vector<Index>>>
find_remnants(const Mesh& mesh, const SeamMarks& seam, double most_area) {
    std::vector<std::pair<double, std::vector<Index>>> found;
    for (std::vector<Index>& patch : patches_of(mesh, seam)) {
        double area = 0.0;
        for (const Face f : patch)
            area += mesh.face_areas[f];
        if (area <= most_area * mesh.total_area)
            found.emplace_back(area, std::move(patch));
    }
    std::sort(found.begin(), found.end());
    return found;
}

// The common borders of a patch with its neighbours, the longest first, without those that must
// stay.
std::vector<std::vector<Index>> common_borders(const Mesh& mesh, const SeamMarks& seam,
                                               const SeamMarks& hard,
                                               const std::vector<Index>& patch) {
    const std::vector<Index> label = find_patches(mesh, seam).label;
    const atlas::ChartSurface surface = atlas::extract_surface(mesh, patch, seam);
    std::vector<std::vector<Index>> borders;
    for (const Index neighbour : atlas::neighbour_labels(mesh, label, surface)) {
        std::vector<Index> border;
        for (const Face f : patch)
            for (const HalfEdge h : half_edges_of(f))
                if (mesh.twin[h] >= 0 && label[face_of(mesh.twin[h])] == neighbour &&
                    !is_marked(hard, h))
                    border.push_back(h);
        if (!border.empty())
            borders.push_back(std::move(border));
    }
    return borders;
}

} // namespace

std::optional<std::vector<Index>> mend_patch(const Mesh& mesh, const VertexGraph& graph,
                                             const std::vector<double>& cost,
                                             const std::vector<Index>& faces, const SeamMarks& seam,
                                             const judge::ClothLimits& limits,
                                             const Progress& progress) {
    SeamMarks marks = seam;
    std::vector<Index> cuts;
    std::vector<std::vector<Index>> open{faces};
    for (int count = 0; !open.empty(); ++count) {
        const std::vector<Index> patch = open.back();
        open.pop_back();
        const judge::ClothTrial trial =
            judge::try_cloth(mesh, patch, marks, limits, false, progress);
        if (trial.accepted)
            continue;
        if (!trial.is_sound || count >= tuning.most_cuts)
            return std::nullopt;
        std::vector<Index> cut =
            judge::cut_between_sheets(mesh, patch, marks, trial.has_map, progress);
        if (cut.empty())
            cut = find_dart(mesh, graph, cost, patch, marks, progress);
        if (cut.empty())
            return std::nullopt;
        mark(mesh, cut, 1, marks);
        cuts.insert(cuts.end(), cut.begin(), cut.end());
        for (std::vector<Index>& part : patches_of(mesh, marks, patch))
            open.push_back(std::move(part));
    }
    return cuts;
}

bool OpenPart::has_open_faces() const {
    return std::find(faces.begin(), faces.end(), 1) != faces.end();
}

bool OpenPart::is_inside(const Mesh& mesh, HalfEdge h) const {
    return is_open(face_of(h)) && (mesh.twin[h] < 0 || is_open(face_of(mesh.twin[h])));
}

OpenPart mend_patches(const Mesh& mesh, const VertexGraph& graph, const std::vector<double>& cost,
                      SeamMarks seam, const judge::ClothLimits& limits, Progress& progress) {
    const std::vector<std::vector<Index>> faces = patches_of(mesh, seam);
    std::vector<std::optional<std::vector<Index>>> cuts(faces.size());
    parallel_for(
        static_cast<int>(faces.size()),
        [&](int p) { cuts[p] = mend_patch(mesh, graph, cost, faces[p], seam, limits, progress); },
        progress);
    OpenPart part{std::vector<std::uint8_t>(mesh.faces.size(), 0), std::move(seam)};
    for (std::size_t p = 0; p < faces.size(); ++p)
        if (cuts[p])
            mark(mesh, *cuts[p], 1, part.seam);
        else
            for (const Face f : faces[p])
                part.faces[f] = 1;
    return part;
}

SeamMarks fixed_seams(const Mesh& mesh, const OpenPart& part) {
    SeamMarks fixed = part.seam;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0 && part.is_inside(mesh, h))
            fixed[h] = 0;
    return fixed;
}

OpenPart same_part(const WorkingSurface& surface, SeamMarks seam, const Mesh& model,
                   const OpenPart& on_model) {
    const Mesh& mesh = surface.mesh;
    const mesh::SurfaceSearch search(model);
    const std::vector<Vec3> normals = mesh::vertex_normals(mesh);
    const mesh::FaceComponents patches = find_patches(mesh, seam);
    std::vector<double> open_area(at(patches.count), 0.0); // less that which is not open
    for (const Face f : mesh.all_faces()) {
        const Vertex v = mesh.faces[f][0];
        const Vertex near = search.vertex(mesh.points[v], normals[v], [](Index) { return true; });
        if (near >= 0)
            open_area[patches.label[f]] += on_model.is_open(face_of(search.leaving(near)))
                                               ? mesh.face_areas[f]
                                               : -mesh.face_areas[f];
    }
    OpenPart part;
    part.seam = std::move(seam);
    for (const Index p : patches.label)
        part.faces.push_back(open_area[p] > 0.0 ? 1 : 0);
    for (Face f = 0; f < mesh.face_count() && surface.is_symmetric(); ++f)
        if (part.faces[f] != 0)
            part.faces[surface.face_image(f)] = 1;
    return part;
}

SeamMarks absorb_specks(const Mesh& mesh, SeamMarks seam) {
    for (const auto& [area, patch] : find_remnants(mesh, seam, tuning.fragment)) {
        if (patches_of(mesh, seam, {patch.front()}).front() != patch)
            continue;
        // Rather where no seam loses its end.
        std::vector<std::vector<Index>> borders = common_borders(mesh, seam, {}, patch);
        if (borders.empty())
            continue;
        const std::vector<Index> degree = seam_degrees(mesh, seam);
        const auto loose_ends = [&](const std::vector<Index>& border) {
            std::vector<Index> left;
            for (const HalfEdge h : border)
                left.insert(left.end(), {mesh.origin(h), mesh.target(h)});
            std::sort(left.begin(), left.end());
            Index loose = 0;
            for (std::size_t k = 0; k < left.size(); ++k)
                if (k + 1 < left.size() && left[k] == left[k + 1] && degree[left[k]] > 2)
                    ++loose;
            return loose;
        };
        const std::vector<Index>& border =
            *std::min_element(borders.begin(), borders.end(), [&](const auto& a, const auto& b) {
                return loose_ends(a) < loose_ends(b);
            });
        mark(mesh, border, 0, seam);
        open_what_floats(mesh, {}, patches_of(mesh, seam, {patch.front()}).front(), seam);
    }
    return seam;
}

Index absorb_remnants(const SeamSetting& setting, const std::vector<double>& cost, double most_area,
                      SeamMarks& seam, Progress& progress) {
    const Mesh& mesh = setting.mesh();
    Index tried = 0;
    const auto join_along = [&](const std::vector<Index>& border) {
        SeamMarks marks = seam;
        mark_both(setting.surface, border, 0, marks);
        ++tried;
        progress.check();
        const std::vector<Index> joined =
            patches_of(mesh, marks, {face_of(border.front())}).front();
        for (const std::vector<Index>& patch :
             patches_beside(mesh, marks, with_image(setting.surface, {border})))
            open_what_floats(mesh, setting.hard, patch, marks);
        const auto cuts =
            mend_patch(mesh, setting.graph, cost, joined, marks, setting.tester.limits(), progress);
        if (!cuts || length_of(mesh, *cuts) > tuning.longest_darts * length_of(mesh, border))
            return false;
        mark_both(setting.surface, *cuts, 1, marks);
        if (patches_of(mesh, marks, joined).size() > 1 ||
            (setting.surface.is_symmetric() &&
             !setting.tester.accepts_all(
                 patches_beside(mesh, marks, with_image(setting.surface, {border})), marks,
                 progress)))
            return false;
        seam = std::move(marks);
        return true;
    };
    for (const auto& [area, patch] : find_remnants(mesh, seam, most_area)) {
        // Earlier joins may have made it larger.
        if (patches_of(mesh, seam, {patch.front()}).front() != patch)
            continue;
        for (const std::vector<Index>& border : common_borders(mesh, seam, setting.hard, patch))
            if (join_along(border))
                break;
    }
    return tried;
}

} // namespace devseg::plush
