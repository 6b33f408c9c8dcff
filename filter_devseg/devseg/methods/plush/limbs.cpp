#include "devseg/methods/plush/limbs.h"

#include <algorithm>
#include <cmath>

#include "devseg/graph/min_cut.h"

namespace devseg::plush {

namespace {

constexpr int rings = 120;              // by distance from the tip
constexpr double reach = 0.75;          // of the model's extent: roots are not looked for beyond
constexpr double least_share = 0.002;   // of the surface: smaller ends are no limbs
constexpr double most_share = 0.35;     // and larger ones no limbs but bodies
constexpr double least_widening = 1.35; // of the ring behind a root over the ring before it
constexpr double inner_band = 0.75;     // the cut lies within these shares of the root's distance
constexpr double outer_band = 1.3;
constexpr double concave_gain = 4.0; // how much cheaper an edge of curvature −1 is than a flat one
constexpr double same_limb = 0.6;    // common area over the area of both together

struct Root {
    double distance = 0.0;
    double widening = 0.0;
};

class LimbFinder {
public:
    LimbFinder(const Mesh& mesh, const VertexGraph& graph, const std::vector<double>& curvature)
        : mesh_(mesh), graph_(graph), curvature_(curvature), length_(mesh.twin.size()) {
        for (const HalfEdge h : mesh.all_half_edges())
            length_[h] = mesh.edge_length(h);
    }

    Limb find(Index tip, const Progress& progress) const {
        const PathTree tree = shortest_paths(graph_, length_, {tip}, progress);
        std::vector<double> distance(mesh_.faces.size());
        double farthest = 0.0;
        for (std::size_t f = 0; f < distance.size(); ++f) {
            const Triangle& t = mesh_.faces[f];
            distance[f] = (tree.distance[t[0]] + tree.distance[t[1]] + tree.distance[t[2]]) / 3.0;
            if (std::isfinite(distance[f]))
                farthest = std::max(farthest, distance[f]);
        }
        const Root root = find_root(distance, farthest);
        Limb limb;
        limb.tip = tip;
        if (root.widening >= least_widening)
            limb.faces = cut_off(tip, distance, root.distance);
        return limb;
    }

private:
    // The distance at which the rings around the tip widen most.
    Root find_root(const std::vector<double>& distance, double farthest) const {
        const double width = reach * farthest / rings;
        std::vector<double> area(rings, 0.0);
        for (std::size_t f = 0; f < distance.size(); ++f) {
            const double ring = distance[f] / width;
            if (ring < rings)
                area[static_cast<std::size_t>(ring)] += mesh_.face_areas[f];
        }
        const auto mean = [&](int from, int to) {
            double sum = 0.0;
            for (int i = from; i < to; ++i)
                sum += area[static_cast<std::size_t>(i)];
            return sum / (to - from);
        };
        Root root;
        double inside = 0.0;
        for (int i = 0; i < rings; ++i) {
            inside += area[static_cast<std::size_t>(i)];
            const double share = inside / mesh_.total_area;
            // A window that grows with the distance sees roots of all sizes alike.
            const int window = std::max(2, i / 5);
            if (i < 6 || share < least_share || i - window < 0 || i + 1 + 2 * window > rings)
                continue;
            if (share > most_share)
                break;
            const double before = mean(i - window, i);
            const double after = mean(i + 1 + window / 2, i + 1 + window / 2 + window);
            if (before > 0.0 && after / before > root.widening)
                root = {(i + 0.5) * width, after / before};
        }
        return root;
    }

    double concavity_cost(HalfEdge h) const {
        const double bend = 0.5 * (curvature_[mesh_.origin(h)] + curvature_[mesh_.target(h)]);
        return mesh_.edge_length(h) / (1.0 + concave_gain * std::max(0.0, -bend)) *
               (1.0 + 0.5 * std::min(4.0, std::max(0.0, bend)));
    }

    std::vector<Index> cut_off(Index tip, const std::vector<double>& distance, double root) const {
        std::vector<graph::CutSide> start(mesh_.faces.size(), graph::CutSide::open);
        for (std::size_t f = 0; f < start.size(); ++f) {
            if (distance[f] < inner_band * root)
                start[f] = graph::CutSide::source;
            else if (!(distance[f] < outer_band * root))
                start[f] = graph::CutSide::sink;
        }
        graph::MinCut cut(start);
        for (const HalfEdge h : mesh_.all_half_edges())
            if (mesh_.twin[h] > h)
                cut.link(h / 3, mesh_.twin[h] / 3, concavity_cost(h));
        const std::vector<graph::CutSide> side = cut.solve();
        return component(tip, side);
    }

    std::vector<Index> component(Index tip, const std::vector<graph::CutSide>& side) const {
        std::vector<std::uint8_t> seen(mesh_.faces.size(), 0);
        std::vector<Index> faces;
        double area = 0.0;
        const auto take = [&](Face f) {
            if (seen[f] != 0 || side[f] != graph::CutSide::source)
                return;
            seen[f] = 1;
            faces.push_back(f);
            area += mesh_.face_areas[f];
        };
        for (const Face f : mesh_.all_faces())
            for (const Vertex v : mesh_.faces[f])
                if (v == tip)
                    take(f);
        for (std::size_t k = 0; k < faces.size(); ++k)
            for (const HalfEdge h : half_edges_of(faces[k]))
                if (mesh_.twin[h] >= 0)
                    take(mesh_.twin[h] / 3);
        std::sort(faces.begin(), faces.end());
        if (area > most_share * mesh_.total_area)
            faces.clear();
        return faces;
    }

    const Mesh& mesh_;
    const VertexGraph& graph_;
    const std::vector<double>& curvature_;
    std::vector<double> length_; // 3 #F
};

double area_of(const Mesh& mesh, const std::vector<Index>& faces) {
    double area = 0.0;
    for (const Face f : faces)
        area += mesh.face_areas[f];
    return area;
}

bool are_much_the_same(const Mesh& mesh, const Limb& a, const Limb& b) {
    std::vector<Index> common;
    std::set_intersection(a.faces.begin(), a.faces.end(), b.faces.begin(), b.faces.end(),
                          std::back_inserter(common));
    const double both = area_of(mesh, common);
    return both > same_limb * (area_of(mesh, a.faces) + area_of(mesh, b.faces) - both);
}

} // namespace

std::vector<Limb> find_limbs(const Mesh& mesh, const VertexGraph& graph,
                             const std::vector<double>& curvature, const std::vector<Index>& tips,
                             const Progress& progress) {
    const LimbFinder finder(mesh, graph, curvature);
    std::vector<Limb> limbs;
    for (const Index tip : tips) {
        progress.check();
        Limb limb = finder.find(tip, progress);
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
            if (mesh.twin[h] >= 0 && inside[mesh.twin[h] / 3] == 0)
                border.push_back(h);
    return border;
}

} // namespace devseg::plush
