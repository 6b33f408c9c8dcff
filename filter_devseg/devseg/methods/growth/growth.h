// Charts that grow from seeds at the same time, each with a heap of its own [JKS05, section 3.1]:
// the machinery of D-Charts, t-flooding, Variational Shape Approximation and Multi-Chart Geometry
// Images, which differ in the cost of adding a face.
#pragma once

#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/graph/heap.h"
#include "devseg/mesh/flat_regions.h"
#include "devseg/mesh/mesh.h"

namespace devseg::growth {

/// A face that a chart may take next.
struct Candidate {
    float key;      // cost without the factor that all entries of this chart share
    float distance; // length of the path from the chart's seed
    Index face;

    bool operator<(const Candidate& other) const {
        return key != other.key ? key < other.key : face < other.face; // ties: deterministic
    }
};
using CandidateHeap = graph::Heap<Candidate>;

/// The key of a chart without candidates, above all others: infinity, or a default.
template <class Key>
constexpr Key no_key() {
    if constexpr (std::is_floating_point_v<Key>)
        return std::numeric_limits<Key>::infinity();
    else
        return {};
}

/// Finds the chart with the smallest key among all, after one chart's key changed: O(log n).
template <class Key = float>
class Tournament {
public:
    explicit Tournament(Index players) {
        while (leaves_ < players)
            leaves_ *= 2;
        keys_.assign(at(leaves_), no_key<Key>());
        winner_.assign(at(2 * leaves_), 0);
        for (Index i = 0; i < leaves_; ++i)
            winner_[leaves_ + i] = i;
        for (Index node = leaves_ - 1; node > 0; --node)
            winner_[node] = better(winner_[2 * node], winner_[2 * node + 1]);
    }
    void set(Index player, Key key) {
        keys_[player] = key;
        for (Index node = (leaves_ + player) / 2; node > 0; node /= 2)
            winner_[node] = better(winner_[2 * node], winner_[2 * node + 1]);
    }
    Index winner() const { return winner_[1]; }
    const Key& key(Index player) const { return keys_[player]; }

private:
    Index better(Index a, Index b) const {
        return keys_[b] < keys_[a] ? b : a; // ties: the lower number, which is a
    }
    Index leaves_ = 1;
    std::vector<Key> keys_;
    std::vector<Index> winner_;
};

/// Whether a face keeps the key of its first offer to a chart, or takes the best of all.
enum class Offers { first, best };

/// Grows charts over the faces that have none until no chart has a candidate. A chart that takes a
/// face of a facet takes all of it.
///
/// A `Cost` answers three questions:
///     CandidateHeap::Entry candidate(h, c)   the face behind h, offered to chart c; face −1: not
///     Key key(c, entry)                      rank of chart c with its best candidate: the least is
///                                            next; a float below infinity, or a type whose default
///                                            is above all others
///     void take(f, c, distance)              face f has joined chart c, with the entry's distance
template <Offers offers>
class MultiHeap {
public:
    explicit MultiHeap(const Mesh& mesh, mesh::Facets facets = {})
        : mesh_(mesh), facets_(std::move(facets)) {}

    /// One chart from each seed; these must be distinct faces, no two of one facet. `chart` (#F) is
    /// overwritten; −1 where no seed reaches.
    template <class Cost>
    void grow(const std::vector<Index>& seeds, Cost& cost, std::vector<Index>& chart,
              const Progress& progress) {
        chart.assign(mesh_.faces.size(), -1);
        const Index count = static_cast<Index>(seeds.size());
        front_ = seeds;
        for (Index c = 0; c < count; ++c) {
            chart[seeds[c]] = c;
            cost.take(seeds[c], c, 0.0F);
            for (const Face f : facets_.around(seeds[c]))
                if (chart[f] < 0) {
                    chart[f] = c;
                    cost.take(f, c, 0.0F);
                    front_.push_back(f);
                }
        }
        spread(front_, count, cost, chart, progress);
    }

    /// Goes on with `count` charts from faces of theirs.
    template <class Cost>
    void spread(const std::vector<Index>& front, Index count, Cost& cost, std::vector<Index>& chart,
                const Progress& progress) {
        using Key = decltype(cost.key(0, std::declval<CandidateHeap::Entry>()));
        heaps_.resize(at(count));
        for (CandidateHeap& heap : heaps_)
            heap.clear();
        for (const Face f : front) // all are in their charts: no offer was the first
            offer_neighbours(f, cost, chart, true);
        Tournament<Key> tournament(count);
        for (Index c = 0; c < count; ++c)
            tournament.set(c, key_of<Key>(c, cost, chart));
        Heartbeat beat(progress);
        while (tournament.key(tournament.winner()) < no_key<Key>()) {
            const Index c = tournament.winner();
            const CandidateHeap::Entry entry = heaps_[c].top();
            const Face f = entry.face;
            if (chart[f] < 0) { // another chart may have taken it since
                heaps_[c].pop();
                take(f, c, entry.distance, cost, chart);
                for (const Face g : facets_.around(f))
                    if (chart[g] < 0)
                        take(g, c, entry.distance, cost, chart);
                beat();
            }
            tournament.set(c, key_of<Key>(c, cost, chart));
        }
    }

private:
    template <class Cost>
    void take(Face f, Index c, float distance, Cost& cost, std::vector<Index>& chart) {
        chart[f] = c;
        cost.take(f, c, distance);
        offer_neighbours(f, cost, chart);
    }

    template <class Key, class Cost>
    Key key_of(Index c, Cost& cost, const std::vector<Index>& chart) {
        CandidateHeap& heap = heaps_[c];
        while (!heap.empty() && chart[heap.top().face] >= 0)
            heap.pop();
        return heap.empty() ? no_key<Key>() : cost.key(c, heap.top());
    }

    template <class Cost>
    void offer_neighbours(Face f, Cost& cost, const std::vector<Index>& chart, bool all = false) {
        const Index c = chart[f];
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge twin = mesh_.twin[h];
            if (twin < 0 || chart[face_of(twin)] >= 0 || facets_.are_one(f, face_of(twin)))
                continue;
            if (!all && offers == Offers::first && !is_first_offer(twin, c, chart))
                continue;
            const CandidateHeap::Entry entry = cost.candidate(h, c);
            if (entry.face >= 0)
                heaps_[c].push(entry);
        }
    }

    // A face was offered before if another neighbour of it is in the chart already.
    bool is_first_offer(HalfEdge twin, Index c, const std::vector<Index>& chart) const {
        for (const HalfEdge h : {Mesh::next(twin), Mesh::previous(twin)}) {
            const HalfEdge other = mesh_.twin[h];
            if (other >= 0 && face_of(other) != face_of(mesh_.twin[twin]) &&
                chart[face_of(other)] == c)
                return false;
        }
        return true;
    }

    const Mesh& mesh_;
    const mesh::Facets facets_;
    std::vector<CandidateHeap> heaps_;
    std::vector<Index> front_; // scratch of grow()
};

} // namespace devseg::growth
