#include "devseg/curves/smooth_seams.h"

#include <algorithm>
#include <cmath>

#include "devseg/curves/smoothing.h"
#include "devseg/curves/splitting.h"
#include "devseg/graph/unions.h"

namespace devseg::curves {

namespace {

struct Tuning {
    int attempts = 6;     // each keeps the curves on their edges that failed before
    double crease = 4.0;  // scales: shorter creases are bumps, and hold nothing
    double rounds = 12.0; // for each edge in one scale: curves pass one vertex in each
    double least_rounds = 24.0;
    double most_rounds = 120.0;
    double least_edges = 1.0; // mean edges of the seams: the least scale, below which edges show
};
constexpr Tuning tuning;

double diagonal(const Mesh& mesh) {
    Vec3 low = Vec3::Constant(infinite);
    Vec3 high = Vec3::Constant(-infinite);
    for (const Vec3& p : mesh.points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    return (high - low).norm();
}

bool is_seam(const Mesh& mesh, const atlas::ChartMap& charts, HalfEdge h) {
    return charts.seam[h] != 0 && mesh.twin[h] >= 0 && h < mesh.twin[h];
}

double length_of_seams(const Mesh& mesh, const atlas::ChartMap& charts) {
    double length = 0.0;
    for (const HalfEdge h : mesh.all_half_edges())
        if (is_seam(mesh, charts, h))
            length += mesh.edge_length(h);
    return length;
}

// Seam edges on creases that are long enough.
std::vector<std::uint8_t> crease_edges(const Mesh& mesh, const atlas::ChartMap& charts,
                                       double angle, double scale) {
    std::vector<std::uint8_t> held(mesh.twin.size(), 0);
    graph::Unions parts(mesh.points.size());
    const double cosine = std::cos(angle * degrees);
    for (const HalfEdge h : mesh.all_half_edges())
        if (is_seam(mesh, charts, h) &&
            mesh.face_normals[face_of(h)].dot(mesh.face_normals[mesh.across(h)]) < cosine) {
            held[h] = held[mesh.twin[h]] = 1;
            parts.join(parts.find(mesh.origin(h)), parts.find(mesh.target(h)));
        }
    std::vector<double> length(mesh.points.size(), 0.0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (held[h] != 0)
            length[parts.find(mesh.origin(h))] += 0.5 * mesh.edge_length(h);
    for (const HalfEdge h : mesh.all_half_edges())
        if (held[h] != 0 && length[parts.find(mesh.origin(h))] < tuning.crease * scale)
            held[h] = 0;
    return held;
}

double mean_edge(const Mesh& mesh, const atlas::ChartMap& charts) {
    double length = 0.0;
    Index edges = 0;
    for (const HalfEdge h : mesh.all_half_edges())
        if (is_seam(mesh, charts, h)) {
            length += mesh.edge_length(h);
            ++edges;
        }
    return edges > 0 ? length / edges : 0.0;
}

} // namespace

SmoothSeams smooth_seams(const Mesh& mesh, const atlas::ChartMap& charts,
                         const SmoothOptions& options, Progress& progress,
                         const std::vector<std::uint8_t>& held_too) {
    check_ranges(options);
    const double edge = mean_edge(mesh, charts);
    const double scale = std::max(options.smoothness * diagonal(mesh), tuning.least_edges * edge);
    const int rounds = edge > 0.0
                           ? static_cast<int>(std::clamp(tuning.rounds * scale / edge,
                                                         tuning.least_rounds, tuning.most_rounds))
                           : 1;
    std::vector<std::uint8_t> held = crease_edges(mesh, charts, options.keep_creases, scale);
    for (std::size_t h = 0; h < held_too.size(); ++h)
        held[h] = held[h] != 0 || held_too[h] != 0 ? 1 : 0;
    SmoothSeams result;
    bool done = false;
    for (int attempt = 0; attempt < tuning.attempts && !done; ++attempt) {
        auto part = progress.part("smoothing seams", attempt == 0 ? 0.7 : 0.5 * progress.left());
        Network network(mesh, charts, held);
        smooth(network, scale, rounds, part);
        SplitMesh split = split_along(network, charts, progress);
        done = split.failed.empty();
        result.smooth_seams = result.kept_seams = 0;
        for (const Curve& curve : network.curves)
            ++(curve.held || !done ? result.kept_seams : result.smooth_seams);
        if (done) {
            result.refinement = std::move(split.refinement);
            result.charts = std::move(split.charts);
        }
        for (const Index c : split.failed)
            for (const HalfEdge h : network.curves[c].path)
                held[h] = held[mesh.twin[h]] = 1;
    }
    if (!done) { // the mesh as it is
        result.refinement = mesh::refine(mesh, {}, {});
        result.charts = charts;
    }
    result.old_length = length_of_seams(mesh, charts);
    result.new_length = length_of_seams(result.refinement.mesh, result.charts);
    return result;
}

} // namespace devseg::curves
