#include "devseg/methods/plush/fit_surface.h"

#include <utility>
#include <vector>

#include "devseg/mesh/surface_search.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

// Means over each vertex and its neighbours, so many times.
void smooth(const VertexGraph& graph, int rounds, std::vector<Vec3>& moves) {
    for (int round = 0; round < rounds; ++round) {
        std::vector<Vec3> next = moves;
        for (std::size_t v = 0; v < moves.size(); ++v) {
            for (Index i = graph.begin[v]; i < graph.begin[v + 1]; ++i)
                next[v] += moves[graph.vertex[i]];
            next[v] /= 1.0 + graph.begin[v + 1] - graph.begin[v];
        }
        moves = std::move(next);
    }
}

} // namespace

Mesh fitted_to(const Mesh& model, const Mesh& surface, const VertexGraph& graph,
               const Progress& progress) {
    const mesh::SurfaceSearch search(model);
    Mesh fitted = surface;
    std::vector<Vec3> moves(surface.points.size(), Vec3::Zero());
    const auto anywhere = [](Index) { return true; };
    for (int turn = 0; turn < tuning.fit_turns; ++turn) {
        const std::vector<Vec3> normal = mesh::vertex_normals(fitted);
        for (const Vertex v : surface.all_vertices()) {
            if (v % 1024 == 0)
                progress.check();
            const Vec3& p = fitted.points[v];
            // Along the model it is the neighbours' move: tips come off worst from
            // nearest points.
            if (const Vertex near = search.vertex(p, normal[v], anywhere); near >= 0) {
                const Vec3& across = search.normal(near);
                const Vec3 place = search.on_faces(p, near, anywhere).second;
                moves[v] += (place - p).dot(across) * across;
            }
        }
        // Whole limbs first, then what is smaller.
        smooth(graph, tuning.fit_turns - turn, moves);
        for (const Vertex v : surface.all_vertices())
            fitted.points[v] = surface.points[v] + moves[v];
        mesh::compute_face_geometry(fitted);
    }
    return fitted;
}

} // namespace devseg::plush
