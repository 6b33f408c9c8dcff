#include "devseg/methods/plush/seam_curves.h"

#include "devseg/atlas/charts.h"
#include "devseg/mesh/surface_search.h"

namespace devseg::plush {

namespace {

constexpr int rounds = 3;
constexpr int rounds_on_surface = 3; // after so many rounds points go back to the surface

// The vertices that pull at each vertex of a seam; none at those that stay.
std::vector<std::vector<Index>> find_threads(const Mesh& mesh, const SeamMarks& seam) {
    const std::vector<Index> degree = seam_degrees(mesh, seam);
    const std::vector<std::uint8_t> on_border = mesh::boundary_vertices(mesh);
    std::vector<std::vector<Index>> threads(mesh.points.size());
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Vertex v = mesh.origin(h);
        if (seam[h] == 0 || degree[v] < 2 || on_border[v] != 0)
            continue;
        threads[v].push_back(mesh.target(h));
    }
    return threads;
}

} // namespace

std::vector<Vec3> smooth_seams(const Mesh& mesh, const SeamMarks& seam) {
    const std::vector<std::vector<Index>> threads = find_threads(mesh, seam);
    const mesh::SurfaceSearch search(mesh);
    std::vector<Vec3> points = mesh.points;
    for (int round = 1; round <= rounds; ++round) {
        std::vector<Vec3> next = points;
        for (std::size_t v = 0; v < threads.size(); ++v) {
            if (threads[v].empty())
                continue;
            Vec3 sum = Vec3::Zero();
            for (const Index u : threads[v])
                sum += points[u];
            next[v] = 0.5 * points[v] + 0.5 / static_cast<double>(threads[v].size()) * sum;
            if (round % rounds_on_surface != 0)
                continue;
            const Index near = search.vertex(next[v], search.normal(static_cast<Index>(v)),
                                             [](Index) { return true; });
            if (near >= 0)
                next[v] = search.on_faces(next[v], near, [](Index) { return true; }).second;
        }
        points = std::move(next);
    }
    return points;
}

} // namespace devseg::plush
