#include "devseg/plush/darts.h"

#include <cmath>

namespace devseg {

namespace {

constexpr int most_darts = 3;

// The inner vertex where the conformal map shrinks most; −1 where nothing lies inside.
Index shrunk_vertex(const Mesh& mesh, const PatchTrial& map,
                    const std::vector<std::uint8_t>& on_border) {
    std::vector<double> area(mesh.points.size(), 0.0);
    std::vector<double> flat_area(mesh.points.size(), 0.0);
    for (std::size_t i = 0; i < map.face.size(); ++i)
        for (const Index v : mesh.faces[at(map.face[i])]) {
            area[at(v)] += mesh.face_areas[at(map.face[i])];
            flat_area[at(v)] += mesh.face_areas[at(map.face[i])] * (1.0 + map.change[i]);
        }
    Index least = -1;
    for (std::size_t v = 0; v < area.size(); ++v)
        if (area[v] > 0.0 && on_border[v] == 0 &&
            (least < 0 || flat_area[v] * area[at(least)] < flat_area[at(least)] * area[v]))
            least = static_cast<Index>(v);
    return least;
}

} // namespace

std::optional<std::vector<Index>> find_darts(const Mesh& mesh, const VertexGraph& graph,
                                             const std::vector<double>& cost,
                                             const std::vector<Index>& faces, const SeamMarks& seam,
                                             const PatchLimits& limits, const Progress& progress) {
    SeamMarks marks = seam;
    std::vector<std::uint8_t> inside(mesh.points.size(), 0);
    for (const Index f : faces)
        for (const Index v : mesh.faces[at(f)])
            inside[at(v)] = 1;
    std::vector<Index> darts;
    for (int dart = 0;; ++dart) {
        const PatchTrial trial = try_patch(mesh, faces, marks, limits, false, progress);
        if (trial.accepted)
            return darts;
        if (!trial.is_disk || dart == most_darts)
            return std::nullopt;
        std::vector<std::uint8_t> on_border(mesh.points.size(), 0);
        for (const Index f : faces)
            for (Index h = 3 * f; h < 3 * f + 3; ++h)
                if (marks[at(h)] != 0 || mesh.twin[at(h)] < 0)
                    on_border[at(mesh.origin(h))] = on_border[at(mesh.target(h))] = 1;
        const Index tip = shrunk_vertex(mesh, conformal_change(mesh, faces, marks), on_border);
        if (tip < 0)
            return std::nullopt;
        const PathTree tree = shortest_paths(graph, cost, {tip}, inside, on_border);
        Index end = -1;
        for (std::size_t v = 0; v < on_border.size(); ++v)
            if (on_border[v] != 0 && std::isfinite(tree.distance[v]) &&
                (end < 0 || tree.distance[v] < tree.distance[at(end)]))
                end = static_cast<Index>(v);
        if (end < 0)
            return std::nullopt;
        for (const Index h : trace_path(mesh, tree, end)) {
            mark(mesh, h, 1, marks);
            darts.push_back(h);
        }
    }
}

} // namespace devseg
