#include "devseg/curves/smooth_seams.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "devseg/curves/smoothing.h"
#include "devseg/curves/splitting.h"
#include "devseg/graph/unions.h"

namespace devseg::curves {

namespace {

struct Tuning {
    int attempts = 8;       // each keeps what failed before on its edges
    int whole_attempts = 3; // the last ones, which keep whole curves
    double around = 1.5;    // mean edges: what is kept around a place that failed; twice each time
    double crease = 4.0;    // scales: shorter creases are bumps, and hold nothing
    double rounds = 12.0;   // for each edge in one scale: curves pass one vertex in each
    double least_rounds = 24.0;
    double most_rounds = 120.0;
    double symmetric_within = 0.03; // of the diagonal: nine tenths of a model's points
    double least_edges = 1.0; // mean edges of the seams: the least scale, below which edges show
};
constexpr Tuning tuning;

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

// Whether the curve was drawn to a mirror image until now.
bool leave_alone(const Curve& curve, const Mesh& mesh, std::vector<std::uint8_t>& alone) {
    if (curve.held || curve.path.empty() || alone[curve.path.front()] != 0)
        return false;
    for (const HalfEdge h : curve.path)
        alone[h] = alone[mesh.twin[h]] = 1;
    return true;
}

// Keeps the edges of a path that are near to the face, at least the nearest one; all of them where
// there is no face.
void hold_around(const std::vector<HalfEdge>& path, const Mesh& mesh, Index face, double reach,
                 std::vector<std::uint8_t>& held) {
    const auto distance = [&](HalfEdge h) {
        const Vec3 middle = 0.5 * (mesh.points[mesh.origin(h)] + mesh.points[mesh.target(h)]);
        return face < 0 ? 0.0 : (middle - mesh.face_centers[face]).norm();
    };
    double nearest = infinite;
    for (const HalfEdge h : path)
        nearest = std::min(nearest, distance(h));
    for (const HalfEdge h : path)
        if (distance(h) <= std::max(nearest, reach))
            held[h] = held[mesh.twin[h]] = 1;
}

// Smooth seams, and those that stay on their edges. A seam may consist of several curves, which
// meet in its vertices that are curved.
std::pair<Index, Index> count_seams(const Network& network, bool done) {
    const auto count = static_cast<Index>(network.curves.size());
    graph::Unions seams(at(count));
    for (const Node& node : network.nodes)
        if (!node.is_junction() && node.curves.size() == 2 &&
            network.curves[node.curves[0]].held == network.curves[node.curves[1]].held)
            seams.join(seams.find(node.curves[0]), seams.find(node.curves[1]));
    std::vector<std::uint8_t> is_smooth(at(count), 0);
    for (Index c = 0; c < count; ++c)
        if (done && network.curves[c].first >= 0)
            is_smooth[at(seams.find(c))] = 1;
    std::pair<Index, Index> counts{0, 0};
    for (Index c = 0; c < count; ++c)
        if (seams.find(c) == c)
            ++(is_smooth[at(c)] != 0 ? counts.first : counts.second);
    return counts;
}

} // namespace

double smoothing_scale(const Mesh& mesh, const atlas::ChartMap& charts,
                       const SmoothOptions& options) {
    return std::max(options.smoothness * mesh::mesh_diagonal(mesh),
                    tuning.least_edges * mean_edge(mesh, charts));
}

std::optional<mesh::MirrorPlane> seam_plane(const Mesh& mesh, const SmoothOptions& options,
                                            Progress& progress) {
    if (!options.symmetric)
        return std::nullopt;
    auto finding = progress.part("finding the mirror plane", 1.0);
    return mesh::find_mirror_plane(mesh, tuning.symmetric_within, finding);
}

SmoothSeams smooth_seams(const Mesh& mesh, const atlas::ChartMap& charts,
                         const SmoothOptions& options, Progress& progress) {
    auto finding = progress.part(0.2);
    const auto plane = seam_plane(mesh, options, finding);
    return smooth_seams(mesh, charts, options, plane, progress);
}

SmoothSeams smooth_seams(const Mesh& mesh, const atlas::ChartMap& charts,
                         const SmoothOptions& options,
                         const std::optional<mesh::MirrorPlane>& plane, Progress& progress,
                         const std::vector<Firmness>& firmness) {
    check_ranges(options);
    const double edge = mean_edge(mesh, charts);
    const double scale = smoothing_scale(mesh, charts, options);
    const int rounds = edge > 0.0
                           ? static_cast<int>(std::clamp(tuning.rounds * scale / edge,
                                                         tuning.least_rounds, tuning.most_rounds))
                           : 1;
    std::vector<std::uint8_t> held = crease_edges(mesh, charts, options.keep_creases, scale);
    for (std::size_t h = 0; h < firmness.size(); ++h)
        held[h] = held[h] != 0 || firmness[h] == Firmness::held ? 1 : 0;
    const CurvedVertices curved(
        mesh, firmness.empty() ? std::vector<Firmness>(held.size(), Firmness::free) : firmness);
    SmoothingAims aims{scale, rounds, std::vector<std::uint8_t>(held.size(), 0), plane};
    SmoothSeams result;
    result.has_plane = aims.plane.has_value();
    double reach = tuning.around * edge;
    bool done = false;
    for (int attempt = 0; attempt < tuning.attempts && !done; ++attempt) {
        auto part = progress.part("smoothing seams", (attempt == 0 ? 0.7 : 0.5) * progress.left());
        Network network(mesh, charts, held, curved);
        smooth(network, curved, aims, part);
        SplitMesh split = split_along(network, charts, progress);
        done = split.failed.empty();
        std::tie(result.smooth_seams, result.kept_seams) = count_seams(network, done);
        if (done) {
            result.refinement = std::move(split.refinement);
            result.charts = std::move(split.charts);
        }
        const bool whole = attempt + tuning.whole_attempts >= tuning.attempts;
        // What cannot be cut beside a mirror image is smoothed without one first.
        for (const Failure& failure : split.failed)
            if (const Curve& curve = network.curves[failure.curve];
                whole || !aims.plane || !leave_alone(curve, mesh, aims.alone))
                hold_around(curve.path, mesh, whole ? -1 : failure.face, reach, held);
        reach *= 2.0;
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
