// Shortest paths from any number of sources over nodes 0 … n − 1, be they vertices or faces.
//
// References
//   E. W. Dijkstra: A Note on Two Problems in Connexion with Graphs. Numerische Mathematik 1, 1959.
//   doi:10.1007/BF01386390
#pragma once

#include <type_traits>
#include <vector>

#include "devseg/base/numbers.h"
#include "devseg/base/progress.h"
#include "devseg/graph/heap.h"

namespace devseg::graph {

/// The caller says what neighbours are. From node 0 up to the first goal:
///
///     ShortestPaths<> paths(count);
///     paths.add_source(0);
///     paths.run([&](Index v, double distance) {
///         for (const Edge& e : edges_from(v))
///             paths.reach(e.target, distance + e.length, e.number);
///         return !is_goal(v);
///     });
///
/// Nodes are visited in the order of their distance, of equals the lowest number first; of paths of
/// the same length the first that was offered counts. So results are the same on any machine. A
/// bound on the distance, or closed nodes, are paths that are not offered.
template <class Length = double>
class ShortestPaths {
public:
    std::vector<Length> distance; // #nodes, infinite where nothing leads
    std::vector<Index> step; // #nodes: what came with the last step of the path; −1 = nothing

    explicit ShortestPaths(std::size_t nodes)
        : distance(nodes, static_cast<Length>(infinite)), step(nodes, -1) {}

    /// A place where paths begin; more may come between two runs, and during one.
    void add_source(Index node) {
        put(node, Length{});
        step[node] = -1;
    }

    /// Offers a path to a node, of length ≥ that of the node visited now; returns whether it is
    /// shorter than all before. `last` (≥ 0) is anything that names its last step.
    bool reach(Index node, Length through) {
        if (!(through < distance[node]))
            return false;
        put(node, through);
        return true;
    }
    void reach(Index node, Length through, Index last) {
        if (reach(node, through))
            step[node] = last;
    }

    /// Calls visit(node, distance) for each node that is reached, until there are no more or visit
    /// returns false. The next run goes on from there. Throws Cancelled.
    template <class Visit>
    void run(Visit visit, const Progress& progress = Progress()) {
        Heartbeat beat(progress);
        while (!queue_.empty()) {
            beat();
            const Entry next = queue_.top();
            queue_.pop();
            if (next.distance > distance[next.node])
                continue;
            if constexpr (std::is_void_v<decltype(visit(next.node, next.distance))>)
                visit(next.node, next.distance);
            else if (!visit(next.node, next.distance))
                return;
        }
    }

    /// Forgets all paths, in the time that it took to find them.
    void clear() {
        for (const Index node : touched_) {
            distance[node] = static_cast<Length>(infinite);
            step[node] = -1;
        }
        touched_.clear();
        queue_.clear();
    }

private:
    struct Entry {
        Length distance;
        Index node;
        bool operator<(const Entry& other) const {
            return distance != other.distance ? distance < other.distance : node < other.node;
        }
    };
    void put(Index node, Length through) {
        if (distance[node] == static_cast<Length>(infinite))
            touched_.push_back(node);
        distance[node] = through;
        queue_.push({through, node});
    }

    Heap<Entry> queue_;
    std::vector<Index> touched_;
};

} // namespace devseg::graph
