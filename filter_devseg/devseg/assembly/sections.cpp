#include "devseg/assembly/sections.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <set>
#include <tuple>

#include "devseg/assembly/assembly.h"
#include "devseg/assembly/limbs.h"
#include "devseg/graph/unions.h"

namespace devseg::assembly {

namespace {

struct Tuning {
    // P² / 4πA of a limb: a tube with a closed end, from a third of its width in length on.
    double limb = 0.35;
    double holes = 0.1;              // of the surface: a solid with so much of hems is a garment
    std::size_t many_neighbours = 3; // a body: it has limbs, and is none
};
constexpr Tuning tuning;

// Sections while they grow; those that were joined to others are empty.
class Clusters {
public:
    explicit Clusters(const PieceGraph& graph)
        : area_(graph.area), mm_(graph.mm), version_(graph.area.size(), 0) {
        for (Index i = 0; i < graph.piece_count; ++i) {
            into_.push_back(i);
            mm_[at(i)].erase(i);
        }
    }

    Index count() const { return static_cast<Index>(area_.size()); }
    bool is_there(Index a) const { return into_[at(a)] == a && area_[at(a)] > 0.0; }
    bool is_open(Index a) const { return is_there(a) && !is_limb(a); }
    double area(Index a) const { return area_[at(a)]; }
    // Counts what was joined to it.
    Index version(Index a) const { return version_[at(a)]; }
    // Those that it shares seams with, and their lengths.
    const std::map<Index, double>& neighbours(Index a) const { return mm_[at(a)]; }

    // Length of the seams to others.
    double border(Index a) const {
        double sum = 0.0;
        for (const auto& [c, length] : mm_[at(a)])
            sum += length;
        return sum;
    }
    static double openness(double border, double area) { return border * border / (4 * pi * area); }
    double openness_of_union(Index a, Index b) const {
        return openness(border(a) + border(b) - 2.0 * mm_[at(a)].at(b), area(a) + area(b));
    }

    void join(Index a, Index b) {
        for (const auto& [c, length] : mm_[at(b)]) {
            mm_[at(c)].erase(b);
            if (c == a)
                continue;
            const double both = mm_[at(a)][c] + length;
            mm_[at(a)][c] = mm_[at(c)][a] = both;
        }
        mm_[at(b)].clear();
        area_[at(a)] += area_[at(b)];
        into_[at(b)] = a;
        ++version_[at(a)];
    }

    // The section of each piece.
    std::vector<Index> of_piece() const {
        std::vector<Index> result;
        for (Index i : into_) {
            while (into_[at(i)] != i)
                i = into_[at(i)];
            result.push_back(i);
        }
        return result;
    }

private:
    bool is_limb(Index a) const { return openness(border(a), area(a)) < tuning.limb; }

    std::vector<double> area_;
    std::vector<std::map<Index, double>> mm_;
    std::vector<Index> version_;
    std::vector<Index> into_; // itself where it is there
};

// Unions of two that are no limbs, the most closed one first.
class Unions {
public:
    explicit Unions(Clusters& clusters) : clusters_(clusters) {
        for (Index a = 0; a < clusters.count(); ++a)
            add(a, a);
    }

    // Makes the most closed one; false where there is none.
    bool join_best() {
        while (!candidates_.empty()) {
            const Candidate best = candidates_.top();
            candidates_.pop();
            if (!is_current(best.a, best.version_a) || !is_current(best.b, best.version_b))
                continue;
            clusters_.join(best.a, best.b);
            add(best.a, -1);
            return true;
        }
        return false;
    }

private:
    struct Candidate {
        double openness;
        Index a, b, version_a, version_b;
        bool operator<(const Candidate& other) const { // the largest comes first
            return std::tie(openness, a, b) > std::tie(other.openness, other.a, other.b);
        }
    };

    bool is_current(Index a, Index version) const {
        return clusters_.is_there(a) && clusters_.version(a) == version;
    }
    // Unions with neighbours above `least`.
    void add(Index a, Index least) {
        if (!clusters_.is_open(a))
            return;
        for (const auto& [c, length] : clusters_.neighbours(a))
            if (c > least && length > 0.0 && clusters_.is_open(c)) {
                const auto [low, high] = std::minmax(a, c);
                candidates_.push({clusters_.openness_of_union(low, high), low, high,
                                  clusters_.version(low), clusters_.version(high)});
            }
    }

    Clusters& clusters_;
    std::priority_queue<Candidate> candidates_;
};

// Small leftovers are parts of what they share the longest seams with. The lowest number first;
// a union makes others of what it touches.
void join_leftovers(Clusters& clusters, const Progress& progress) {
    std::set<Index> waiting;
    for (Index a = 0; a < clusters.count(); ++a)
        waiting.insert(a);
    while (!waiting.empty()) {
        progress.check();
        const Index a = *waiting.begin();
        waiting.erase(waiting.begin());
        if (!clusters.is_open(a) || clusters.neighbours(a).size() >= tuning.many_neighbours)
            continue;
        Index best = -1;
        double most = 0.0;
        for (const auto& [b, length] : clusters.neighbours(a))
            if (length > most) {
                most = length;
                best = b;
            }
        if (best < 0 || clusters.area(best) < clusters.area(a))
            continue;
        clusters.join(best, a);
        waiting.insert(best);
        for (const auto& [c, length] : clusters.neighbours(best))
            waiting.insert(c);
    }
}

// Of each piece, the limb that holds more than half of it, or −1.
std::vector<Index> limbs_of_pieces(const pattern::Pattern& pattern, const Limbs& limbs) {
    std::vector<std::map<Index, double>> area(pattern.pieces.size()); // on the model
    std::vector<double> whole(pattern.pieces.size(), 0.0);
    for (const Face f : pattern.mesh.all_faces())
        if (const Index p = pattern.face_piece[f]; p >= 0) {
            area[at(p)][limbs.of_face[f]] += pattern.mesh.face_areas[f];
            whole[at(p)] += pattern.mesh.face_areas[f];
        }
    std::vector<Index> result(pattern.pieces.size(), -1);
    for (std::size_t p = 0; p < result.size(); ++p)
        for (const auto& [limb, part] : area[p])
            if (2.0 * part > whole[p])
                result[p] = limb;
    return result;
}

} // namespace

PieceGraph::PieceGraph(const pattern::Pattern& pattern) {
    piece_count = static_cast<Index>(pattern.pieces.size());
    mm.resize(at(piece_count));
    graph::Unions unions(at(piece_count));
    for (const pattern::PatternPiece& piece : pattern.pieces)
        area.push_back(piece.area);
    for (const pattern::Seam& seam : pattern.seams) {
        const Index a = seam.sides[0].piece;
        const Index b = seam.sides[1].piece;
        const double length = 0.5 * (seam.sides[0].length + seam.sides[1].length);
        mm[at(a)][b] += length;
        if (a != b)
            mm[at(b)][a] += length;
        if (unions.find(a) != unions.find(b))
            unions.join(unions.find(a), unions.find(b));
    }
    component.assign(at(piece_count), -1);
    for (Index i = 0; i < piece_count; ++i)
        if (unions.find(i) == i)
            component[at(i)] = component_count++;
    for (Index i = 0; i < piece_count; ++i)
        component[at(i)] = component[at(unions.find(i))];
    measure_solids(pattern);
}

void PieceGraph::measure_solids(const pattern::Pattern& pattern) {
    const Mesh& mesh = pattern.mesh;
    std::vector<double> total(at(component_count), 0.0);
    std::vector<double> holes(at(component_count), 0.0);
    volume.assign(at(component_count), 0.0);
    const auto component_of = [&](Face f) {
        const Index piece = pattern.face_piece[f];
        return piece < 0 ? Index{-1} : component[at(piece)];
    };
    const auto add = [&](Index c, const Vec3& p, const Vec3& q, const Vec3& r) {
        volume[at(c)] += p.dot(q.cross(r)) / 6.0;
    };
    std::vector<std::uint8_t> visited(mesh.twin.size(), 0);
    for (const Face f : mesh.all_faces()) {
        const Index c = component_of(f);
        if (c < 0)
            continue;
        const Triangle& t = mesh.faces[f];
        total[at(c)] += mesh.face_areas[f];
        add(c, mesh.points[at(t[0])], mesh.points[at(t[1])], mesh.points[at(t[2])]);
        for (const HalfEdge start : half_edges_of(f)) {
            if (mesh.twin[start] >= 0 || visited[start] != 0)
                continue;
            std::vector<Vec3> loop;
            double length = 0.0;
            for (HalfEdge h = start; visited[h] == 0; h = mesh.next_on_boundary(h)) {
                visited[h] = 1;
                loop.push_back(mesh.points[mesh.origin(h)]);
                length += mesh.edge_length(h);
            }
            Vec3 middle = Vec3::Zero();
            for (const Vec3& p : loop)
                middle += p / static_cast<double>(loop.size());
            for (std::size_t i = 0; i < loop.size(); ++i)
                add(c, loop[(i + 1) % loop.size()], loop[i], middle);
            holes[at(c)] += length * length / (4.0 * pi);
        }
    }
    const double unit = mesh.unit_length * pattern.mm_per_unit;
    for (std::size_t c = 0; c < volume.size(); ++c) {
        is_closed.push_back(holes[c] <= tuning.holes * total[c] ? 1 : 0);
        volume[c] = is_closed[c] != 0 ? std::abs(volume[c]) * unit * unit * unit : 0.0;
    }
}

Grouping group_by_seams(const PieceGraph& graph, const Progress& progress) {
    Clusters clusters(graph);
    Unions unions(clusters);
    while (unions.join_best())
        progress.check();
    join_leftovers(clusters, progress);
    return {clusters.of_piece(), std::vector<std::uint8_t>(at(graph.piece_count), 0)};
}

Grouping group_by_limbs(const pattern::Pattern& pattern, const PieceGraph& graph,
                        const Progress& progress) {
    Grouping grouping = group_by_seams(graph, progress);
    if (std::count(graph.is_closed.begin(), graph.is_closed.end(), 1) == 0)
        return grouping;
    const Limbs limbs = find_limbs(pattern.mesh, progress);
    const std::vector<Index> limb = limbs_of_pieces(pattern, limbs);
    std::vector<std::uint8_t> has_limbs(at(graph.component_count), 0);
    for (std::size_t p = 0; p < limb.size(); ++p)
        if (limb[p] >= 0)
            has_limbs[at(graph.component[p])] = graph.is_closed[at(graph.component[p])];
    // Numbers after those of sections by seams: of limbs, and then of the bodies of components.
    for (std::size_t p = 0; p < limb.size(); ++p)
        if (const Index c = graph.component[p]; has_limbs[at(c)] != 0) {
            grouping.is_body[p] = limb[p] < 0 ? 1 : 0;
            grouping.section[p] = graph.piece_count + (limb[p] < 0 ? limbs.count + c : limb[p]);
        }
    return grouping;
}

} // namespace devseg::assembly
