#include "devseg/assembly/sections.h"

#include <algorithm>
#include <cmath>

#include "devseg/assembly/assembly.h"
#include "devseg/graph/unions.h"

namespace devseg::assembly {

namespace {

struct Tuning {
    // P² / 4πA of a limb: a tube with a closed end, from a third of its width in length on.
    double limb = 0.35;
    double holes = 0.1;      // of the surface: a solid with so much of hems is a garment
    int many_neighbours = 3; // a body: it has limbs, and is none
};
constexpr Tuning tuning;

// Sections while they grow; those that were joined to others are empty.
class Clusters {
public:
    explicit Clusters(const PieceGraph& graph) : area_(graph.area), mm_(graph.mm) {
        for (Index i = 0; i < graph.piece_count; ++i) {
            of_piece_.push_back(i);
            mm_[at(i)][at(i)] = 0.0;
        }
    }

    Index count() const { return static_cast<Index>(area_.size()); }
    bool is_there(Index a) const { return area_[at(a)] > 0.0; }
    double shared(Index a, Index b) const { return mm_[at(a)][at(b)]; }
    double area(Index a) const { return area_[at(a)]; }
    const std::vector<Index>& of_piece() const { return of_piece_; }

    // Length of the seams to others.
    double border(Index a) const {
        double sum = 0.0;
        for (const double length : mm_[at(a)])
            sum += length;
        return sum;
    }
    int neighbours(Index a) const {
        return static_cast<int>(std::count_if(mm_[at(a)].begin(), mm_[at(a)].end(),
                                              [](double length) { return length > 0.0; }));
    }
    static double openness(double border, double area) { return border * border / (4 * pi * area); }
    bool is_limb(Index a) const { return openness(border(a), area(a)) < tuning.limb; }
    double openness_of_union(Index a, Index b) const {
        return openness(border(a) + border(b) - 2.0 * shared(a, b), area(a) + area(b));
    }

    void join(Index a, Index b) {
        for (Index c = 0; c < count(); ++c) {
            mm_[at(a)][at(c)] = mm_[at(c)][at(a)] = shared(a, c) + shared(b, c);
            mm_[at(b)][at(c)] = mm_[at(c)][at(b)] = 0.0;
        }
        mm_[at(a)][at(a)] = 0.0;
        area_[at(a)] += area_[at(b)];
        area_[at(b)] = 0.0;
        std::replace(of_piece_.begin(), of_piece_.end(), b, a);
    }

private:
    std::vector<double> area_;
    std::vector<std::vector<double>> mm_;
    std::vector<Index> of_piece_;
};

// The most closed union of two that are no limbs; false where there is none.
bool join_best(Clusters& clusters) {
    std::vector<Index> open;
    for (Index a = 0; a < clusters.count(); ++a)
        if (clusters.is_there(a) && !clusters.is_limb(a))
            open.push_back(a);
    double least = infinite;
    std::pair<Index, Index> best{-1, -1};
    for (const Index a : open)
        for (const Index b : open)
            if (a < b && clusters.shared(a, b) > 0.0 && clusters.openness_of_union(a, b) < least) {
                least = clusters.openness_of_union(a, b);
                best = {a, b};
            }
    if (best.first < 0)
        return false;
    clusters.join(best.first, best.second);
    return true;
}

// Small leftovers are parts of what they share the longest seams with.
void join_leftovers(Clusters& clusters) {
    for (bool changed = true; changed;) {
        changed = false;
        for (Index a = 0; a < clusters.count() && !changed; ++a) {
            if (!clusters.is_there(a) || clusters.is_limb(a) ||
                clusters.neighbours(a) >= tuning.many_neighbours)
                continue;
            Index best = -1;
            for (Index b = 0; b < clusters.count(); ++b)
                if (clusters.shared(a, b) > 0.0 &&
                    (best < 0 || clusters.shared(a, b) > clusters.shared(a, best)))
                    best = b;
            if (best < 0 || clusters.area(best) < clusters.area(a))
                continue;
            clusters.join(best, a);
            changed = true;
        }
    }
}

} // namespace

PieceGraph::PieceGraph(const pattern::Pattern& pattern) {
    piece_count = static_cast<Index>(pattern.pieces.size());
    mm.assign(at(piece_count), std::vector<double>(at(piece_count), 0.0));
    graph::Unions unions(at(piece_count));
    for (const pattern::PatternPiece& piece : pattern.pieces)
        area.push_back(piece.area);
    for (const pattern::Seam& seam : pattern.seams) {
        const Index a = seam.sides[0].piece;
        const Index b = seam.sides[1].piece;
        const double length = 0.5 * (seam.sides[0].length + seam.sides[1].length);
        mm[at(a)][at(b)] += length;
        if (a != b)
            mm[at(b)][at(a)] += length;
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

std::vector<Index> find_sections(const PieceGraph& graph) {
    Clusters clusters(graph);
    while (join_best(clusters)) {
    }
    join_leftovers(clusters);
    return clusters.of_piece();
}

} // namespace devseg::assembly
