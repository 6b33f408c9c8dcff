#include "devseg/methods/growth/relabelling.h"

namespace devseg::growth {

namespace {
constexpr Index disk = 2; // twice the Euler characteristic
}

Relabelling::Relabelling(const Mesh& mesh, std::vector<Index>& chart)
    : mesh_(mesh), chart_(chart), valence_(mesh.points.size(), 0), corners_(mesh.points.size(), 0),
      in_flood_(mesh.faces.size(), 0) {
    for (const HalfEdge h : mesh.all_half_edges())
        ++valence_[mesh.origin(h)];
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] < 0)
            valence_[mesh.origin(h)] = valence_[mesh.target(h)] = -1;
}

// Faces that hang together with `start` in its chart, and twice their Euler characteristic: with b
// boundary edges and i inner vertices, V = i + b and 2 E = 3 F + b.
Relabelling::Topology Relabelling::topology(Face start) {
    Topology result;
    reached_.assign(1, start);
    in_flood_[start] = 1;
    for (std::size_t i = 0; i < reached_.size(); ++i)
        for (const HalfEdge h : half_edges_of(reached_[i])) {
            const HalfEdge twin = mesh_.twin[h];
            const Vertex v = mesh_.origin(h);
            result.doubled_euler += ++corners_[v] == valence_[v] ? 2 : 0;
            if (twin < 0 || chart_[face_of(twin)] != chart_[start]) {
                ++result.doubled_euler;
            } else if (in_flood_[face_of(twin)] == 0) {
                in_flood_[face_of(twin)] = 1;
                reached_.push_back(face_of(twin));
            }
        }
    result.faces = static_cast<Index>(reached_.size());
    result.doubled_euler -= result.faces;
    for (const Face f : reached_) {
        in_flood_[f] = 0;
        for (const Vertex v : mesh_.faces[f])
            corners_[v] = 0;
    }
    return result;
}

bool Relabelling::take(const std::array<Side, 2>& sides, const NewLabels& labels,
                       const Rule& rule) {
    const std::array<Topology, 2> before{topology(sides[0].before), topology(sides[1].before)};
    std::array<Index, 2> lost{0, 0};
    NewLabels undo;
    for (const auto& [f, c] : labels) {
        if (chart_[f] == c)
            continue;
        undo.emplace_back(f, chart_[f]);
        ++lost[c == sides[0].chart ? 1 : 0];
        chart_[f] = c;
    }
    bool good = !undo.empty();
    for (std::size_t i = 0; i < 2 && good; ++i) {
        good = sides[i].after >= 0 && lost[i] <= rule.most_lost * before[i].faces;
        if (!good)
            break;
        const Topology after = topology(sides[i].after);
        const Index change = after.doubled_euler - before[i].doubled_euler;
        good = after.faces == before[i].faces - lost[i] + lost[1 - i] &&
               (change == 0 || (rule.may_fill && change > 0 && after.doubled_euler <= disk));
    }
    if (!good)
        for (const auto& [f, c] : undo)
            chart_[f] = c;
    return good;
}

} // namespace devseg::growth
