#include "devseg/methods/plush/mend_patches.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/atlas/fragments.h"
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

// A way of cutting a patch, and what comes of it.
struct Cut {
    std::vector<Index> edges;
    double price = infinite;
    std::vector<std::vector<Index>> failing; // parts that still do not keep the limits
};

// Ways of cutting one patch in two or less.
class Cutter {
public:
    Cutter(const Mesh& mesh, const VertexGraph& graph, const std::vector<double>& cost,
           const SeamMarks& seam, const judge::ClothLimits& limits, const Progress& progress)
        : mesh_(mesh), graph_(graph), cost_(cost), seam_(seam), limits_(limits),
          progress_(progress) {}

    // The cheapest cut, without edges where there is none.
    Cut best(const std::vector<Index>& patch, bool has_map) const {
        const std::vector<Index> between =
            judge::cut_between_sheets(mesh_, patch, seam_, has_map, progress_);
        if (!between.empty())
            return priced(patch, between);
        std::vector<std::uint8_t> on_border(mesh_.points.size(), 0);
        for (const Face f : patch)
            for (const HalfEdge h : half_edges_of(f))
                if (is_border(mesh_, seam_, h))
                    on_border[mesh_.origin(h)] = on_border[mesh_.target(h)] = 1;
        const Vertex tip =
            shrunk_vertex(mesh_, judge::conformal_change(mesh_, patch, seam_), on_border);
        if (tip < 0)
            return {};
        const CutThrough through = cut_through(
            mesh_, graph_, cost_, atlas::extract_surface(mesh_, patch, seam_), tip, progress_);
        Cut cut = priced(patch, through.dart);
        if (!through.rest.empty()) {
            std::vector<Index> both = through.dart;
            both.insert(both.end(), through.rest.begin(), through.rest.end());
            Cut whole = priced(patch, std::move(both));
            if (whole.price < cut.price)
                cut = std::move(whole);
        }
        return cut;
    }

private:
    Cut priced(const std::vector<Index>& patch, std::vector<Index> edges) const {
        Cut cut;
        if (edges.empty())
            return cut;
        cut.price = 0.0;
        SeamMarks marks = seam_;
        mark(mesh_, edges, 1, marks);
        for (const HalfEdge h : edges)
            cut.price += cost_[h];
        for (std::vector<Index>& part : patches_of(mesh_, marks, patch)) {
            const judge::ClothTrial trial =
                judge::try_cloth(mesh_, part, marks, limits_, false, progress_);
            cut.price +=
                prices_.per_patch +
                (trial.outline.empty()
                     ? 0.0
                     : prices_.per_narrow * narrowness(trial.outline, prices_.wide_enough));
            if (!trial.accepted) {
                cut.price += prices_.per_failure;
                cut.failing.push_back(std::move(part));
            }
        }
        cut.edges = std::move(edges);
        return cut;
    }

    const Mesh& mesh_;
    const VertexGraph& graph_;
    const std::vector<double>& cost_;
    const SeamMarks& seam_;
    const judge::ClothLimits& limits_;
    const Progress& progress_;
    const SeamCost prices_;
};

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

} // namespace

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

CutThrough cut_through(const Mesh& mesh, const VertexGraph& graph, const std::vector<double>& cost,
                       const atlas::ChartSurface& surface, Vertex tip, const Progress& progress) {
    const std::vector<Index>& loop = surface.loops.front();
    const auto vertex = [&](std::size_t i) { return surface.vertex[surface.origin(loop[i])]; };
    std::vector<std::uint8_t> may_enter(mesh.points.size(), 0);
    for (const Vertex v : surface.vertex)
        may_enter[v] = 1;
    std::vector<std::uint8_t> on_border(mesh.points.size(), 0);
    for (std::size_t i = 0; i < loop.size(); ++i)
        on_border[vertex(i)] = 1;
    const PathTree tree = shortest_paths(graph, cost, {tip}, progress, may_enter, on_border);
    const auto is_inside = [&](HalfEdge h) {
        const auto has = [&](HalfEdge side) {
            return side >= 0 &&
                   std::binary_search(surface.face.begin(), surface.face.end(), face_of(side));
        };
        return h >= 0 && (has(h) || has(mesh.twin[h]));
    };
    // Places on the loop, the nearest of some; the loop's size where there is none.
    const auto nearest = [&](std::size_t first, std::size_t last, std::size_t but) {
        std::size_t near = loop.size();
        for (std::size_t k = first; k <= last; ++k) {
            const std::size_t i = k % loop.size();
            if (is_inside(tree.half_edge[vertex(i)]) && std::isfinite(tree.distance[vertex(i)]) &&
                (but == loop.size() || vertex(i) != vertex(but)) &&
                (near == loop.size() || tree.distance[vertex(i)] < tree.distance[vertex(near)]))
                near = i;
        }
        return near;
    };
    CutThrough cut;
    const std::size_t near = nearest(0, loop.size() - 1, loop.size());
    if (near == loop.size())
        return cut;
    cut.dart = trace_path(mesh, tree, vertex(near));
    const std::size_t quarter = loop.size() / 4;
    const std::size_t far = nearest(near + quarter, near + loop.size() - quarter, near);
    if (far < loop.size())
        cut.rest = trace_path(mesh, tree, vertex(far));
    return cut;
}

std::optional<std::vector<Index>> mend_patch(const Mesh& mesh, const VertexGraph& graph,
                                             const std::vector<double>& cost,
                                             const std::vector<Index>& faces, const SeamMarks& seam,
                                             const judge::ClothLimits& limits,
                                             const Progress& progress) {
    SeamMarks marks = seam;
    std::vector<Index> cuts;
    std::vector<std::vector<Index>> open{faces};
    const judge::ClothTrial trial = judge::try_cloth(mesh, faces, marks, limits, false, progress);
    if (trial.accepted)
        return cuts;
    if (!trial.is_sound)
        return std::nullopt;
    for (int count = 0; !open.empty(); ++count) {
        const std::vector<Index> patch = open.back();
        open.pop_back();
        if (count >= tuning.most_cuts)
            return std::nullopt;
        Cut cut = Cutter(mesh, graph, cost, marks, limits, progress)
                      .best(patch, count > 0 || trial.has_map);
        if (cut.edges.empty())
            return std::nullopt;
        mark(mesh, cut.edges, 1, marks);
        cuts.insert(cuts.end(), cut.edges.begin(), cut.edges.end());
        for (std::vector<Index>& part : cut.failing)
            open.push_back(std::move(part));
    }
    return cuts;
}

bool OpenPart::has_open_faces() const {
    return std::find(faces.begin(), faces.end(), 1) != faces.end();
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

OpenPart failing_part(const Mesh& mesh, SeamMarks seam, PatchTester& tester, Progress& progress) {
    OpenPart part{std::vector<std::uint8_t>(mesh.faces.size(), 0), std::move(seam)};
    const std::vector<std::vector<Index>> patches = patches_of(mesh, part.seam);
    parallel_for(
        static_cast<int>(patches.size()),
        [&](int p) {
            if (!tester.accepts(patches[p], part.seam, progress))
                for (const Face f : patches[p])
                    part.faces[f] = 1;
        },
        progress);
    return part;
}

void mend_part(const WorkingSurface& surface, const VertexGraph& graph,
               const std::vector<double>& cost, const OpenPart& part,
               const judge::ClothLimits& limits, SeamMarks& seam, const Progress& progress) {
    const SeamMarks before = seam;
    for (const std::vector<Index>& patch : patches_of(surface.mesh, before)) {
        // The second one of two images has its cuts already.
        const bool has_cuts = std::any_of(patch.begin(), patch.end(), [&](Face f) {
            return !std::equal(seam.begin() + 3 * f, seam.begin() + 3 * f + 3,
                               before.begin() + 3 * f);
        });
        if (!part.is_open(patch.front()) || has_cuts)
            continue;
        judge::ClothLimits stricter = limits;
        for (double share = 1.0; share > tuning.least_share; share *= tuning.tighter) {
            stricter.max_strain = share * limits.max_strain;
            stricter.max_area_change = share * limits.max_area_change;
            const auto cuts =
                mend_patch(surface.mesh, graph, cost, patch, before, stricter, progress);
            if (cuts && cuts->empty())
                continue;
            if (cuts)
                mark_both(surface, *cuts, 1, seam);
            break;
        }
    }
}

SeamMarks absorb_specks(const Mesh& mesh, SeamMarks seam) {
    const std::vector<Index> before = find_patches(mesh, seam).label;
    const std::vector<Index> after = atlas::absorb_fragments(mesh, before, tuning.fragment);
    std::vector<Index> joined;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] >= 0 && before[face_of(h)] != before[face_of(mesh.twin[h])] &&
            after[face_of(h)] == after[face_of(mesh.twin[h])]) {
            seam[h] = 0;
            joined.push_back(face_of(h));
        }
    for (const std::vector<Index>& patch : patches_of(mesh, seam, joined))
        open_what_floats(mesh, {}, patch, seam);
    return seam;
}

OpenPart same_part(const WorkingSurface& surface, SeamMarks seam, const Mesh& model,
                   const OpenPart& on_model) {
    const Mesh& mesh = surface.mesh;
    const mesh::SurfaceSearch search(model);
    const std::vector<Vec3> normals = mesh::vertex_normals(mesh);
    const mesh::FaceComponents patches = find_patches(mesh, seam);
    std::vector<double> balance(at(patches.count), 0.0);
    for (const Face f : mesh.all_faces()) {
        const Vertex v = mesh.faces[f][0];
        const Vertex near = search.vertex(mesh.points[v], normals[v], [](Index) { return true; });
        if (near >= 0)
            balance[patches.label[f]] += on_model.is_open(face_of(search.leaving(near)))
                                             ? mesh.face_areas[f]
                                             : -mesh.face_areas[f];
    }
    OpenPart part;
    part.seam = std::move(seam);
    for (const Index p : patches.label)
        part.faces.push_back(balance[p] > 0.0 ? 1 : 0);
    for (Face f = 0; f < mesh.face_count() && surface.is_symmetric(); ++f)
        if (part.faces[f] != 0)
            part.faces[surface.face_image(f)] = 1;
    return part;
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
        const auto joined = patches_beside(mesh, marks, with_image(setting.surface, {border}));
        for (const std::vector<Index>& patch : joined)
            open_what_floats(mesh, setting.hard, patch, marks);
        const auto cuts = mend_patch(mesh, setting.graph, cost, joined.front(), marks,
                                     setting.tester.limits(), progress);
        if (!cuts)
            return false;
        mark_both(setting.surface, *cuts, 1, marks);
        if (patches_of(mesh, marks, joined.front()).size() > 1 ||
            !(saved_cost(setting, seam, marks, setting.tester, progress) > 0.0))
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
