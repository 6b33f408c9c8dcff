#include "devseg/methods/plush/limbs.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "devseg/graph/min_cut.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

struct Root {
    double distance = 0.0;
    double widening = 0.0;
};

// The distance at which the rings around the tip widen most. `distance`: of each face from the tip.
Root find_root(const Mesh& mesh, const std::vector<double>& distance) {
    double farthest = 0.0;
    for (const double d : distance)
        if (std::isfinite(d))
            farthest = std::max(farthest, d);
    const int rings = tuning.limb_rings;
    const double width = tuning.limb_reach * farthest / rings;
    std::vector<double> area(static_cast<std::size_t>(rings), 0.0);
    for (const Face f : mesh.all_faces()) {
        const double ring = distance[f] / width;
        if (ring < rings)
            area[static_cast<std::size_t>(ring)] += mesh.face_areas[f];
    }
    const auto mean = [&](int from, int to) {
        return std::accumulate(area.begin() + from, area.begin() + to, 0.0) / (to - from);
    };
    Root root;
    double inside = 0.0;
    for (int i = 0; i < rings; ++i) {
        inside += area[static_cast<std::size_t>(i)];
        const double share = inside / mesh.total_area;
        // A window that grows with the distance sees roots of all sizes alike.
        const int window = std::max(2, i / 5);
        if (i < 6 || share < tuning.speck || i - window < 0 || i + 1 + 2 * window > rings)
            continue;
        if (share > tuning.largest_limb)
            break;
        const double before = mean(i - window, i);
        const double after = mean(i + 1 + window / 2, i + 1 + window / 2 + window);
        if (before > 0.0 && after / before > root.widening)
            root = {(i + 0.5) * width, after / before};
    }
    return root;
}

double concavity_cost(const Mesh& mesh, const std::vector<double>& curvature, HalfEdge h) {
    const double bend = 0.5 * (curvature[mesh.origin(h)] + curvature[mesh.target(h)]);
    return mesh.edge_length(h) / (1.0 + tuning.concave_gain * std::max(0.0, -bend)) *
           (1.0 + 0.5 * std::min(4.0, std::max(0.0, bend)));
}

// The side of each face of the least cut near the root.
std::vector<graph::CutSide> cut_off(const Mesh& mesh, const std::vector<double>& curvature,
                                    const std::vector<double>& distance, double root) {
    std::vector<graph::CutSide> start(mesh.faces.size(), graph::CutSide::open);
    for (const Face f : mesh.all_faces())
        if (distance[f] < tuning.inner_band * root)
            start[f] = graph::CutSide::source;
        else if (!(distance[f] < tuning.outer_band * root))
            start[f] = graph::CutSide::sink;
    graph::MinCut cut(start);
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] > h)
            cut.link(face_of(h), face_of(mesh.twin[h]), concavity_cost(mesh, curvature, h));
    return cut.solve();
}

double area_of(const Mesh& mesh, const std::vector<Index>& faces) {
    double area = 0.0;
    for (const Face f : faces)
        area += mesh.face_areas[f];
    return area;
}

// The faces on the tip's side that hang together with it, ascending; none where they are a body.
std::vector<Index> faces_around(const Mesh& mesh, Vertex tip,
                                const std::vector<graph::CutSide>& side) {
    std::vector<std::uint8_t> seen(mesh.faces.size(), 0);
    std::vector<Index> faces;
    const auto take = [&](Face f) {
        if (seen[f] != 0 || side[f] != graph::CutSide::source)
            return;
        seen[f] = 1;
        faces.push_back(f);
    };
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.origin(h) == tip)
            take(face_of(h));
    for (std::size_t k = 0; k < faces.size(); ++k)
        for (const HalfEdge h : half_edges_of(faces[k]))
            if (mesh.twin[h] >= 0)
                take(face_of(mesh.twin[h]));
    const double area = area_of(mesh, faces);
    std::sort(faces.begin(), faces.end());
    return area > tuning.largest_limb * mesh.total_area ? std::vector<Index>{} : faces;
}

bool are_much_the_same(const Mesh& mesh, const Limb& a, const Limb& b) {
    std::vector<Index> common;
    std::set_intersection(a.faces.begin(), a.faces.end(), b.faces.begin(), b.faces.end(),
                          std::back_inserter(common));
    const double both = area_of(mesh, common);
    return both > tuning.same_limb * (area_of(mesh, a.faces) + area_of(mesh, b.faces) - both);
}

} // namespace

std::vector<Limb> find_limbs(const Mesh& mesh, const VertexGraph& graph,
                             const std::vector<double>& curvature, const std::vector<Index>& tips,
                             const Progress& progress) {
    const std::vector<double> length = edge_lengths(mesh);
    std::vector<Limb> limbs;
    for (const Vertex tip : tips) {
        progress.check();
        const std::vector<double> from_tip =
            shortest_paths(graph, length, {tip}, progress).distance;
        std::vector<double> distance;
        for (const auto& [a, b, c] : mesh.faces)
            distance.push_back((from_tip[a] + from_tip[b] + from_tip[c]) / 3.0);
        const Root root = find_root(mesh, distance);
        if (root.widening < tuning.limb_widening)
            continue;
        Limb limb{tip, faces_around(mesh, tip, cut_off(mesh, curvature, distance, root.distance))};
        const bool is_new = std::none_of(limbs.begin(), limbs.end(), [&](const Limb& other) {
            return are_much_the_same(mesh, limb, other);
        });
        if (!limb.faces.empty() && is_new)
            limbs.push_back(std::move(limb));
    }
    std::stable_sort(limbs.begin(), limbs.end(), [&](const Limb& a, const Limb& b) {
        return area_of(mesh, a.faces) > area_of(mesh, b.faces);
    });
    return limbs;
}

std::vector<Index> limb_border(const Mesh& mesh, const Limb& limb) {
    std::vector<std::uint8_t> inside(mesh.faces.size(), 0);
    for (const Face f : limb.faces)
        inside[f] = 1;
    std::vector<Index> border;
    for (const Face f : limb.faces)
        for (const HalfEdge h : half_edges_of(f))
            if (mesh.twin[h] >= 0 && inside[face_of(mesh.twin[h])] == 0)
                border.push_back(h);
    return border;
}

} // namespace devseg::plush
