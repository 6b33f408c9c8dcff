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
        for (Index h = 0; h < static_cast<Index>(half_edges); ++h)
            if (surface.twin[at(h)] >= 0) // the boundary is open already
                length_[at(h)] = mesh.edge_length(surface.mesh_half_edge(h));
        next_.resize(half_edges);
        previous_.resize(half_edges);
        loop_of_.assign(half_edges, -1);
        inside_.assign(surface.face.size(), 0);
    }

    bool has(Index face) const { return inside_[at(face)] != 0; }

    void start(Index face) {
        inside_[at(face)] = 1;
        const Index loop = new_loop();
        for (Index h = 3 * face; h < 3 * face + 3; ++h) {
            link(h, Mesh::next(h));
            loop_of_[at(h)] = loop;
            loops_[at(loop)].length += length_[at(h)];
        }
        loops_[at(loop)].size = 3;
        remember(loop, 3 * face);
    }

    /// Adds the face behind half-edge h of the region, and glues all edges that it shares.
    void add(Index h) {
        const Index inner = s_.twin[at(h)];
        inside_[at(inner / 3)] = 1;
        const Index a = Mesh::next(inner);
        const Index b = Mesh::next(a);
        const Index loop = loop_of_[at(h)];
        // h gives way to the face's two other edges.
        link(previous_[at(h)], a);
        link(b, next_[at(h)]);
        if (next_[at(h)] == h) // a loop of this one edge
            link(b, a);
        link(a, b);
        loop_of_[at(a)] = loop_of_[at(b)] = loop;
        loop_of_[at(h)] = -1;
        loops_[at(loop)].size += 1;
        loops_[at(loop)].length += length_[at(a)] + length_[at(b)] - length_[at(h)];
        for (const Index g : {a, b})
            if (s_.twin[at(g)] >= 0 && loop_of_[at(s_.twin[at(g)])] >= 0 && loop_of_[at(g)] >= 0)
                glue(g, s_.twin[at(g)]);
        for (const Index g : {a, b})
            if (loop_of_[at(g)] >= 0)
                remember(loop_of_[at(g)], g);
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
        next_[at(from)] = to;
        previous_[at(to)] = from;
    }

    void remember(Index number, Index h) {
        Loop& loop = loops_[at(number)];
        if (loop.shortest >= 0.0 && loop.length >= remembered_gain * loop.shortest)
            return;
        loop.shortest = loop.length;
        loop.half_edges.clear();
        const Index first = h;
        do {
            if (length_is_cut(h))
                loop.half_edges.push_back(h);
            h = next_[at(h)];
        } while (h != first);
    }
    bool length_is_cut(Index h) const { return s_.twin[at(h)] >= 0; }

    void glue(Index h, Index t) {
        if (loop_of_[at(h)] != loop_of_[at(t)])
            merge(h, t);
        else if (next_[at(h)] == t || next_[at(t)] == h)
            zip(h, t);
        else
            split(h, t);
    }

    // Takes h out of its list.
    void remove(Index h) {
        Loop& loop = loops_[at(loop_of_[at(h)])];
        link(previous_[at(h)], next_[at(h)]);
        loop.length -= length_[at(h)];
        --loop.size;
        loop_of_[at(h)] = -1;
    }

    void zip(Index h, Index t) {
        const Index loop = loop_of_[at(h)];
        const Index rest = next_[at(h)] == t ? next_[at(t)] : next_[at(h)];
        remove(h);
        remove(t);
        if (loops_[at(loop)].size > 0)
            remember(loop, rest);
    }

    // The lists between h and t become loops of their own, the one with fewer edges a new one; the
    // other goes on, with a memory that starts now.
    void split(Index h, Index t) {
        const Index old = loop_of_[at(h)];
        const Index after_h = next_[at(h)];
        const Index after_t = next_[at(t)];
        const Index before_h = previous_[at(h)];
        const Index before_t = previous_[at(t)];
        remove(h);
        remove(t);
        link(before_t, after_h);
        link(before_h, after_t);
        Index a = after_h;
        Index b = after_t;
        while (next_[at(a)] != after_h && next_[at(b)] != after_t) {
            a = next_[at(a)];
            b = next_[at(b)];
        }
        const Index small = next_[at(a)] == after_h ? after_h : after_t;
        const Index large = small == after_h ? after_t : after_h;
        const Index fresh = new_loop();
        relabel(small, fresh);
        loops_[at(old)].size -= loops_[at(fresh)].size;
        loops_[at(old)].length -= loops_[at(fresh)].length;
        loops_[at(old)].shortest = -1.0;
        remember(fresh, small);
        remember(old, large);
    }

    void relabel(Index first, Index loop) {
        Index h = first;
        do {
            loop_of_[at(h)] = loop;
            loops_[at(loop)].length += length_[at(h)];
            ++loops_[at(loop)].size;
            h = next_[at(h)];
        } while (h != first);
    }

    // A handle: the shorter memory is cut.
    void merge(Index h, Index t) {
        Index large = loop_of_[at(h)];
        Index small = loop_of_[at(t)];
        const Loop& shorter = loops_[at(small)].shortest < loops_[at(large)].shortest
                                  ? loops_[at(small)]
                                  : loops_[at(large)];
        cuts_.insert(cuts_.end(), shorter.half_edges.begin(), shorter.half_edges.end());
        if (loops_[at(small)].size > loops_[at(large)].size)
            std::swap(small, large);
        relabel(loop_of_[at(h)] == small ? h : t, large);
        loops_[at(small)] = {};
        const Index after_h = next_[at(h)];
        const Index after_t = next_[at(t)];
        const Index before_h = previous_[at(h)];
        const Index before_t = previous_[at(t)];
        const bool h_alone = after_h == h;
        const bool t_alone = after_t == t;
        remove(h);
        remove(t);
        if (!h_alone && !t_alone) {
            link(before_h, after_t);
            link(before_t, after_h);
        }
        loops_[at(large)].shortest = -1.0;
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
    const auto centre = [&](Index f) -> const Vec3& {
        return mesh.face_centers[at(surface.face[at(f)])];
    };
    const auto offer = [&](Index f) {
        for (Index h = 3 * f; h < 3 * f + 3; ++h) {
            const Index twin = surface.twin[at(h)];
            if (twin < 0 || fronts.has(twin / 3))
                continue;
            int inside = 0;
            for (Index g = twin - twin % 3; g < twin - twin % 3 + 3; ++g)
                inside += surface.twin[at(g)] >= 0 && fronts.has(surface.twin[at(g)] / 3) ? 1 : 0;
            queue.emplace(inside > 1 ? 0 : 1,
                          distance[at(f)] + (centre(f) - centre(twin / 3)).norm(), h);
        }
    };
    fronts.start(0);
    offer(0);
    while (!queue.empty()) {
        beat();
        const auto [rank, d, h] = queue.top();
        queue.pop();
        const Index f = surface.twin[at(h)] / 3;
        if (fronts.has(f))
            continue;
        distance[at(f)] = d;
        fronts.add(h);
        offer(f);
    }
    return fronts.take_cuts();
}

} // namespace devseg::atlas
