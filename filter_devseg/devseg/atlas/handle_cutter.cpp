#include "devseg/atlas/handle_cutter.h"

#include <functional>
#include <queue>
#include <tuple>

#include "devseg/atlas/border_path.h"

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
        for (const HalfEdge h : surface.all_half_edges()) // the boundary is open already
            length_.push_back(surface.twin[h] < 0 ? 0.0
                                                  : cut_cost(mesh, surface.mesh_half_edge(h)));
        next_.resize(length_.size());
        previous_.resize(length_.size());
        loop_of_.assign(length_.size(), -1);
        inside_.assign(surface.faces.size(), 0);
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
        remember(loop, half_edge_of(face, 0));
    }

    /// Adds the face behind half-edge h of the region, and glues all edges that it shares.
    void add(HalfEdge h) {
        const HalfEdge inner = s_.twin[h];
        inside_[face_of(inner)] = 1;
        const HalfEdge a = Mesh::next(inner);
        const HalfEdge b = Mesh::next(a);
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
        for (const HalfEdge g : {a, b})
            if (s_.twin[g] >= 0 && loop_of_[s_.twin[g]] >= 0 && loop_of_[g] >= 0)
                glue(g, s_.twin[g]);
        for (const HalfEdge g : {a, b})
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
    void link(HalfEdge from, HalfEdge to) {
        next_[from] = to;
        previous_[to] = from;
    }

    void remember(Index number, HalfEdge h) {
        Loop& loop = loops_[number];
        if (loop.shortest >= 0.0 && loop.length >= remembered_gain * loop.shortest)
            return;
        loop.shortest = loop.length;
        loop.half_edges.clear();
        for_loop(h, [&](HalfEdge k) {
            if (s_.twin[k] >= 0)
                loop.half_edges.push_back(k);
        });
    }

    template <class Visit>
    void for_loop(HalfEdge first, Visit visit) const {
        HalfEdge h = first;
        do {
            visit(h);
            h = next_[h];
        } while (h != first);
    }

    void glue(HalfEdge h, HalfEdge t) {
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

    void zip(HalfEdge h, HalfEdge t) {
        const Index loop = loop_of_[h];
        const HalfEdge rest = next_[h] == t ? next_[t] : next_[h];
        remove(h);
        remove(t);
        if (loops_[loop].size > 0)
            remember(loop, rest);
    }

    // The lists between h and t become loops of their own, the one with fewer edges a new one; the
    // other goes on, with a memory that starts now.
    void split(HalfEdge h, HalfEdge t) {
        const Index old = loop_of_[h];
        const HalfEdge after_h = next_[h];
        const HalfEdge after_t = next_[t];
        const HalfEdge before_h = previous_[h];
        const HalfEdge before_t = previous_[t];
        remove(h);
        remove(t);
        link(before_t, after_h);
        link(before_h, after_t);
        HalfEdge a = after_h;
        HalfEdge b = after_t;
        while (next_[a] != after_h && next_[b] != after_t) {
            a = next_[a];
            b = next_[b];
        }
        const HalfEdge small = next_[a] == after_h ? after_h : after_t;
        const HalfEdge large = small == after_h ? after_t : after_h;
        const Index fresh = new_loop();
        relabel(small, fresh);
        loops_[old].size -= loops_[fresh].size;
        loops_[old].length -= loops_[fresh].length;
        loops_[old].shortest = -1.0;
        remember(fresh, small);
        remember(old, large);
    }

    void relabel(HalfEdge first, Index loop) {
        for_loop(first, [&](HalfEdge h) {
            loop_of_[h] = loop;
            loops_[loop].length += length_[h];
            ++loops_[loop].size;
        });
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
        const HalfEdge before_h = previous_[h];
        const HalfEdge before_t = previous_[t];
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
    std::vector<double> length_;     // 3 #f: what it costs to cut there
    std::vector<HalfEdge> next_;     // 3 #f
    std::vector<HalfEdge> previous_; // 3 #f
    std::vector<Index> loop_of_;     // 3 #f: −1 = not on a wavefront
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
    std::vector<double> distance(surface.faces.size(), 0.0);
    const auto centre = [&](Face f) -> const Vec3& { return mesh.face_centers[surface.face[f]]; };
    const auto is_inside = [&](HalfEdge h) {
        return surface.twin[h] >= 0 && fronts.has(surface.across(h));
    };
    const auto offer = [&](Face f) {
        for (const HalfEdge h : half_edges_of(f)) {
            const Face g = surface.across(h);
            if (g < 0 || fronts.has(g))
                continue;
            int inside = 0;
            for (const HalfEdge k : half_edges_of(g))
                inside += is_inside(k) ? 1 : 0;
            queue.emplace(inside > 1 ? 0 : 1, distance[f] + (centre(f) - centre(g)).norm(), h);
        }
    };
    fronts.start(0);
    offer(0);
    while (!queue.empty()) {
        beat();
        const auto [rank, d, h] = queue.top();
        queue.pop();
        const Face f = surface.across(h);
        if (fronts.has(f))
            continue;
        distance[f] = d;
        fronts.add(h);
        offer(f);
    }
    return fronts.take_cuts();
}

} // namespace devseg::atlas
