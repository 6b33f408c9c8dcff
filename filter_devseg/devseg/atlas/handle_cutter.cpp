#include "devseg/atlas/handle_cutter.h"

#include <functional>
#include <queue>
#include <tuple>

namespace devseg::atlas {

namespace {

// A loop is remembered anew when it has become this much shorter: copies cost time.
constexpr double remembered_gain = 0.98;

// The region as its boundary: half-edges in circular lists. Faces join one by one; the edges they
// share with the region are glued one by one, and each glueing changes the lists in one of four
// ways: two neighbours vanish, a loop vanishes, a loop splits, or two loops merge.
class Wavefronts {
public:
    Wavefronts(const Mesh& mesh, const ChartSurface& surface) : s_(surface) {
        const std::size_t half_edges = 3 * surface.face.size();
        length_.resize(half_edges, 0.0);
        for (HalfEdge h = 0; h < static_cast<Index>(half_edges); ++h)
            if (surface.twin[h] >= 0) // the boundary is open already
                length_[h] = mesh.edge_length(surface.mesh_half_edge(h));
        next_.resize(half_edges);
        previous_.resize(half_edges);
        loop_of_.assign(half_edges, -1);
        inside_.assign(surface.face.size(), 0);
    }

    bool has(Face face) const { return inside_[face] != 0; }

    void start(Face face) {
        inside_[face] = 1;
        const Index loop = new_loop();
        for (const HalfEdge h : half_edges_of(face)) {
            link(h, Mesh::next(h));
            loop_of_[h] = loop;
            loops_[loop].length += length_[h];
        }
        loops_[loop].size = 3;
        remember(loop, 3 * face);
    }

    /// Adds the face behind half-edge h of the region, and glues all edges that it shares.
    void add(HalfEdge h) {
        const Index inner = s_.twin[h];
        inside_[inner / 3] = 1;
        const Index a = Mesh::next(inner);
        const Index b = Mesh::next(a);
        const Index loop = loop_of_[h];
        // h gives way to the face's two other edges.
        link(previous_[h], a);
        link(b, next_[h]);
        if (next_[h] == h) // a loop of this one edge
            link(b, a);
        link(a, b);
        loop_of_[a] = loop_of_[b] = loop;
        loop_of_[h] = -1;
        loops_[loop].size += 1;
        loops_[loop].length += length_[a] + length_[b] - length_[h];
        for (const Index g : {a, b})
            if (s_.twin[g] >= 0 && loop_of_[s_.twin[g]] >= 0 && loop_of_[g] >= 0)
                glue(g, s_.twin[g]);
        for (const Index g : {a, b})
            if (loop_of_[g] >= 0)
                remember(loop_of_[g], g);
    }

    std::vector<Index> take_cuts() { return std::move(cuts_); }

private:
    struct Loop {
        double length = 0.0;
        Index size = 0;
        double shortest = -1.0;        // −1 = nothing remembered yet
        std::vector<Index> half_edges; // when it was shortest
    };

    Index new_loop() {
        loops_.emplace_back();
        return static_cast<Index>(loops_.size()) - 1;
    }
    void link(Index from, Index to) {
        next_[from] = to;
        previous_[to] = from;
    }

    void remember(Index number, HalfEdge h) {
        Loop& loop = loops_[number];
        if (loop.shortest >= 0.0 && loop.length >= remembered_gain * loop.shortest)
            return;
        loop.shortest = loop.length;
        loop.half_edges.clear();
        const Index first = h;
        do {
            if (length_is_cut(h))
                loop.half_edges.push_back(h);
            h = next_[h];
        } while (h != first);
    }
    bool length_is_cut(HalfEdge h) const { return s_.twin[h] >= 0; }

    void glue(HalfEdge h, Index t) {
        if (loop_of_[h] != loop_of_[t])
            merge(h, t);
        else if (next_[h] == t || next_[t] == h)
            zip(h, t);
        else
            split(h, t);
    }

    // Takes h out of its list.
    void remove(HalfEdge h) {
        Loop& loop = loops_[loop_of_[h]];
        link(previous_[h], next_[h]);
        loop.length -= length_[h];
        --loop.size;
        loop_of_[h] = -1;
    }

    void zip(HalfEdge h, Index t) {
        const Index loop = loop_of_[h];
        const Index rest = next_[h] == t ? next_[t] : next_[h];
        remove(h);
        remove(t);
        if (loops_[loop].size > 0)
            remember(loop, rest);
    }

    // The lists between h and t become loops of their own, the one with fewer edges a new one; the
    // other goes on, with a memory that starts now.
    void split(HalfEdge h, Index t) {
        const Index old = loop_of_[h];
        const HalfEdge after_h = next_[h];
        const HalfEdge after_t = next_[t];
        const Index before_h = previous_[h];
        const Index before_t = previous_[t];
        remove(h);
        remove(t);
        link(before_t, after_h);
        link(before_h, after_t);
        Index a = after_h;
        Index b = after_t;
        while (next_[a] != after_h && next_[b] != after_t) {
            a = next_[a];
            b = next_[b];
        }
        const Index small = next_[a] == after_h ? after_h : after_t;
        const Index large = small == after_h ? after_t : after_h;
        const Index fresh = new_loop();
        relabel(small, fresh);
        loops_[old].size -= loops_[fresh].size;
        loops_[old].length -= loops_[fresh].length;
        loops_[old].shortest = -1.0;
        remember(fresh, small);
        remember(old, large);
    }

    void relabel(Index first, Index loop) {
        HalfEdge h = first;
        do {
            loop_of_[h] = loop;
            loops_[loop].length += length_[h];
            ++loops_[loop].size;
            h = next_[h];
        } while (h != first);
    }

    // A handle: the shorter memory is cut.
    void merge(HalfEdge h, HalfEdge t) {
        Index large = loop_of_[h];
        Index small = loop_of_[t];
        const Loop& shorter =
            loops_[small].shortest < loops_[large].shortest ? loops_[small] : loops_[large];
        cuts_.insert(cuts_.end(), shorter.half_edges.begin(), shorter.half_edges.end());
        if (loops_[small].size > loops_[large].size)
            std::swap(small, large);
        relabel(loop_of_[h] == small ? h : t, large);
        loops_[small] = {};
        const HalfEdge after_h = next_[h];
        const HalfEdge after_t = next_[t];
        const Index before_h = previous_[h];
        const Index before_t = previous_[t];
        const bool h_alone = after_h == h;
        const bool t_alone = after_t == t;
        remove(h);
        remove(t);
        if (!h_alone && !t_alone) {
            link(before_h, after_t);
            link(before_t, after_h);
        }
        loops_[large].shortest = -1.0;
        if (!h_alone)
            remember(large, after_h);
        else if (!t_alone)
            remember(large, after_t);
    }

    const ChartSurface& s_;
    std::vector<double> length_;  // 3 #f: what it costs to cut there
    std::vector<Index> next_;     // 3 #f
    std::vector<Index> previous_; // 3 #f
    std::vector<Index> loop_of_;  // 3 #f: −1 = not on a wavefront
    std::vector<std::uint8_t> inside_;
    std::vector<Loop> loops_;
    std::vector<Index> cuts_;
};

} // namespace

std::vector<Index> cut_handles(const Mesh& mesh, const ChartSurface& surface,
                               const Progress& progress) {
    Heartbeat beat(progress);
    Wavefronts fronts(mesh, surface);
    // Faces with two neighbours inside shorten the wavefront and come first, then the nearest.
    using Entry = std::tuple<int, double, Index>; // (class, distance, half-edge of the region)
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    std::vector<double> distance(surface.face.size(), 0.0);
    const auto centre = [&](Face f) -> const Vec3& { return mesh.face_centers[surface.face[f]]; };
    const auto offer = [&](Face f) {
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge twin = surface.twin[h];
            if (twin < 0 || fronts.has(twin / 3))
                continue;
            int inside = 0;
            for (Index g = twin - twin % 3; g < twin - twin % 3 + 3; ++g)
                inside += surface.twin[g] >= 0 && fronts.has(surface.twin[g] / 3) ? 1 : 0;
            queue.emplace(inside > 1 ? 0 : 1, distance[f] + (centre(f) - centre(twin / 3)).norm(),
                          h);
        }
    };
    fronts.start(0);
    offer(0);
    while (!queue.empty()) {
        beat();
        const auto [rank, d, h] = queue.top();
        queue.pop();
        const Face f = surface.twin[h] / 3;
        if (fronts.has(f))
            continue;
        distance[f] = d;
        fronts.add(h);
        offer(f);
    }
    return fronts.take_cuts();
}

} // namespace devseg::atlas
