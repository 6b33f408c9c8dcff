#include "devseg/mesh/refinement.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace devseg::mesh {

namespace {

// The edge of the old face that two of its points lie on, −1 for none.
Index common_edge(const Vec3& a, const Vec3& b) {
    for (Index k = 0; k < 3; ++k) // edge k is opposite corner k + 2
        if (a[(k + 2) % 3] == 0.0 && b[(k + 2) % 3] == 0.0)
            return k;
    return -1;
}

struct OpenEdge {
    Index low;
    Index high;
    HalfEdge half_edge;
    bool operator<(const OpenEdge& other) const {
        return std::tuple(low, high, Index{half_edge}) <
               std::tuple(other.low, other.high, Index{other.half_edge});
    }
};

// Open edges with the same ends become twins.
void link(std::vector<OpenEdge> open, Mesh& fine) {
    std::sort(open.begin(), open.end());
    for (std::size_t i = 0; i + 1 < open.size(); ++i)
        if (open[i].low == open[i + 1].low && open[i].high == open[i + 1].high) {
            fine.twin[open[i].half_edge] = open[i + 1].half_edge;
            fine.twin[open[i + 1].half_edge] = open[i].half_edge;
            ++i;
        }
}

} // namespace

Index old_edge(const Refinement::Part& part, Index e) {
    return common_edge(part.corners[at(e)], part.corners[at((e + 1) % 3)]);
}

Refinement refine(const Mesh& mesh, std::vector<Refinement::Point> points,
                  const std::vector<SplitFace>& splits) {
    Refinement result;
    Mesh& fine = result.mesh;
    fine.points = mesh.points;
    fine.unit_length = mesh.unit_length;
    for (const Refinement::Point& p : points) {
        Vec3 place = Vec3::Zero();
        for (Index k = 0; k < 3; ++k)
            place += p.weights[k] * mesh.points[mesh.faces[p.face][k]];
        fine.points.push_back(place);
    }
    result.points = std::move(points);
    fine.faces = mesh.faces;
    fine.twin = mesh.twin;
    std::vector<HalfEdge> whole(mesh.twin.size()); // where old half-edges are that are not cut
    for (const HalfEdge h : mesh.all_half_edges())
        whole[h] = h;
    std::vector<OpenEdge> open;
    std::vector<HalfEdge> moved; // old half-edges of split faces that are not cut
    for (const SplitFace& split : splits) {
        for (std::size_t i = 0; i < split.parts.size(); ++i) {
            const Index f = i == 0 ? Index{split.face} : fine.face_count();
            if (i > 0) {
                fine.faces.emplace_back();
                fine.twin.resize(fine.twin.size() + 3);
            }
            Refinement::Part part{f, split.face, {}};
            for (Index k = 0; k < 3; ++k) {
                const Index p = split.parts[i][at(k)];
                const Index q = split.parts[i][at((k + 1) % 3)];
                fine.faces[f][at(k)] = split.points[p];
                part.corners[at(k)] = split.weights[p];
                const HalfEdge h = half_edge_of(f, k);
                fine.twin[h] = -1;
                const Index edge = common_edge(split.weights[p], split.weights[q]);
                if (edge >= 0 && p < 3 && q < 3) {
                    const HalfEdge old = half_edge_of(split.face, edge);
                    whole[old] = h;
                    moved.push_back(old);
                } else {
                    open.push_back({std::min(split.points[p], split.points[q]),
                                    std::max(split.points[p], split.points[q]), h});
                }
            }
            result.parts.push_back(part);
        }
    }
    for (const HalfEdge old : moved) {
        const HalfEdge other = mesh.twin[old];
        fine.twin[whole[old]] = other < 0 ? HalfEdge() : whole[other];
        if (other >= 0)
            fine.twin[whole[other]] = whole[old];
    }
    link(std::move(open), fine);
    std::sort(result.parts.begin(), result.parts.end(),
              [](const auto& a, const auto& b) { return a.face < b.face; });
    compute_face_geometry(fine);
    return result;
}

} // namespace devseg::mesh
