#include "devseg/mesh/stand_ins.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace devseg::mesh {

namespace {

bool repeats_a_vertex(const Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

std::pair<Index, Index> edge_of(const Triangle& t, Index e) {
    return std::minmax(Index{t[at(e)]}, Index{t[at((e + 1) % 3)]});
}

// Edges by their ends, with what lies on them.
class EdgeTable {
public:
    using Entry = std::tuple<Index, Index, Index>; // the ends, the lower one first, and the item

    void add(const std::pair<Index, Index>& ends, Index item) {
        entries_.emplace_back(ends.first, ends.second, item);
    }
    void sort() { std::sort(entries_.begin(), entries_.end()); }

    // The first item there, but for one; −1 = none.
    Index find(const std::pair<Index, Index>& ends, Index except = -1) const {
        for (auto entry = std::lower_bound(entries_.begin(), entries_.end(),
                                           Entry{ends.first, ends.second, -1});
             entry != entries_.end() && std::get<0>(*entry) == ends.first &&
             std::get<1>(*entry) == ends.second;
             ++entry)
            if (std::get<2>(*entry) != except)
                return std::get<2>(*entry);
        return -1;
    }

private:
    std::vector<Entry> entries_;
};

class StandIns {
public:
    StandIns(const SourceFaces& faces, std::size_t vertex_count, GatedMesh& gated)
        : faces_(faces), gated_(gated), face_at_vertex_(vertex_count, -1) {}

    void find() {
        gated_.stand_in.assign(faces_.joined.size(), -1);
        for (std::size_t f = 0; f < gated_.source_face.size(); ++f)
            gated_.stand_in[gated_.source_face[f]] = static_cast<Index>(f);
        if (gated_.source_face.size() == faces_.joined.size())
            return;
        for (std::size_t f = 0; f < gated_.source_face.size(); ++f)
            for (const Vertex v : faces_.joined[gated_.source_face[f]])
                face_at_vertex_[v] = static_cast<Index>(f);
        find_collapsed();
        find_beside();
        take_from_edges();
        for (std::size_t f = 0; f < faces_.joined.size(); ++f)
            if (gated_.stand_in[f] < 0)
                gated_.stand_in[f] = stand_in_of(f);
        for (CollapsedFace& face : gated_.collapsed)
            find_corners(face);
    }

private:
    // Not those of parts without area, nor those that were given with a vertex twice.
    void find_collapsed() {
        for (std::size_t f = 0; f < faces_.joined.size(); ++f)
            if (gated_.stand_in[f] < 0 && repeats_a_vertex(faces_.joined[f]) &&
                !repeats_a_vertex(faces_.given[f]))
                gated_.collapsed.emplace_back().source = static_cast<Index>(f);
    }

    void find_beside() {
        std::vector<std::uint8_t> is_near(face_at_vertex_.size(), 0);
        for (const CollapsedFace& face : gated_.collapsed)
            for (const Triangle* t : {&faces_.given[face.source], &faces_.joined[face.source]})
                for (const Vertex v : *t)
                    is_near[v] = 1;
        EdgeTable given;
        EdgeTable joined;
        const auto add = [&](EdgeTable& table, const Triangle& t, Index e, HalfEdge h) {
            const auto ends = edge_of(t, e);
            if (is_near[ends.first] != 0 && is_near[ends.second] != 0)
                table.add(ends, h);
        };
        for (const HalfEdge h : gated_.mesh.all_half_edges()) {
            const Index source = gated_.source_face[face_of(h)];
            const Index e = gated_.source_edge(face_of(h), corner_of(h));
            add(given, faces_.given[source], e, h);
            add(joined, faces_.joined[source], e, h);
        }
        EdgeTable collapsed;
        for (std::size_t i = 0; i < gated_.collapsed.size(); ++i)
            for (Index e = 0; e < 3; ++e)
                collapsed.add(edge_of(faces_.given[gated_.collapsed[i].source], e),
                              static_cast<Index>(i));
        given.sort();
        joined.sort();
        collapsed.sort();
        for (std::size_t i = 0; i < gated_.collapsed.size(); ++i) {
            CollapsedFace& face = gated_.collapsed[i];
            for (Index e = 0; e < 3; ++e) {
                const auto ends = edge_of(faces_.given[face.source], e);
                face.on[at(e)] = joined.find(edge_of(faces_.joined[face.source], e));
                face.beside[at(e)] = given.find(ends);
                if (face.beside[at(e)] < 0)
                    face.next[at(e)] = collapsed.find(ends, static_cast<Index>(i));
            }
        }
    }

    // Those on an edge first, then those beside them, in rounds: neighbours that take the results
    // of one face need no seam between them.
    void take_from_edges() {
        std::vector<Index> reached;
        for (std::size_t i = 0; i < gated_.collapsed.size(); ++i) {
            const CollapsedFace& face = gated_.collapsed[i];
            const HalfEdge h = *std::max_element(face.on.begin(), face.on.end());
            if (h < 0)
                continue;
            gated_.stand_in[face.source] = face_of(h);
            reached.push_back(static_cast<Index>(i));
        }
        for (std::size_t i = 0; i < reached.size(); ++i) {
            const CollapsedFace& face = gated_.collapsed[reached[i]];
            for (const Index other : face.next) {
                if (other < 0 || gated_.stand_in[gated_.collapsed[other].source] >= 0)
                    continue;
                gated_.stand_in[gated_.collapsed[other].source] = gated_.stand_in[face.source];
                reached.push_back(other);
            }
        }
    }

    Index stand_in_of(std::size_t f) const {
        if (faces_.duplicate_of[f] >= 0 && gated_.stand_in[faces_.duplicate_of[f]] >= 0)
            return gated_.stand_in[faces_.duplicate_of[f]];
        for (const Vertex v : faces_.joined[f])
            if (face_at_vertex_[v] >= 0)
                return face_at_vertex_[v];
        return 0;
    }

    void find_corners(CollapsedFace& face) const {
        const Face f = gated_.stand_in[face.source];
        const Triangle& t = faces_.joined[gated_.source_face[f]];
        for (Index k = 0; k < 3; ++k)
            for (Index corner = 0; corner < 3; ++corner)
                if (t[at(gated_.source_corner(f, corner))] == faces_.joined[face.source][at(k)])
                    face.at[at(k)] = half_edge_of(f, corner);
    }

    const SourceFaces& faces_;
    GatedMesh& gated_;
    std::vector<Index> face_at_vertex_; // by joined vertices
};

} // namespace

void find_stand_ins(const SourceFaces& faces, std::size_t vertex_count, GatedMesh& gated) {
    StandIns(faces, vertex_count, gated).find();
}

} // namespace devseg::mesh
