// Charts that grow from seeds at the same time, each with a heap of its own: the machinery of
// t-flooding, Variational Shape Approximation and Multi-Chart Geometry Images.
#pragma once

#include <tuple>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/methods/growth/growth.h"

namespace devseg::growth {

/// Rank of a chart's best candidate among those of all charts, compared from first to last.
struct GrowthKey {
    int tier = 2; // a higher one waits until no chart has a candidate in a lower one; 2 = none
    double cost = 0.0;
    float time = 0.0F;

    bool operator<(const GrowthKey& other) const {
        return std::tie(tier, cost, time) < std::tie(other.tier, other.cost, other.time);
    }
};

/// Grows one chart from each seed until every face that the seeds reach has one.
///
/// A `Cost` answers three questions:
///     CandidateHeap::Entry candidate(h, c)   face twin[h] / 3, offered to chart c across h
///     GrowthKey key(c, entry)                rank of chart c with its best candidate
///     void take(f, c, distance)              face f joins chart c, with the entry's distance
/// and `Cost::keeps_first_offer` says whether a face keeps the key of its first offer to a chart,
/// or takes the best of all.
class MultiHeap {
public:
    explicit MultiHeap(const Mesh& mesh) : mesh_(mesh) {}

    /// `chart` (#F) is overwritten; −1 where no seed reaches. Seeds must be distinct faces.
    template <class Cost>
    void grow(const std::vector<Index>& seeds, Cost& cost, std::vector<Index>& chart,
              Progress& progress) {
        const Index count = static_cast<Index>(seeds.size());
        chart.assign(mesh_.faces.size(), -1);
        heaps_.resize(seeds.size());
        for (CandidateHeap& heap : heaps_)
            heap.clear();
        for (Index c = 0; c < count; ++c) {
            chart[seeds[c]] = c;
            cost.take(seeds[c], c, 0.0F);
        }
        for (Index c = 0; c < count; ++c)
            offer_neighbours(seeds[c], c, cost, chart);
        Tournament<GrowthKey> tournament(count, GrowthKey{});
        for (Index c = 0; c < count; ++c)
            tournament.set(c, key_of(c, cost, chart));
        for (Index taken = count; tournament.key(tournament.winner()).tier < GrowthKey{}.tier;) {
            const Index c = tournament.winner();
            const CandidateHeap::Entry entry = heaps_[c].top();
            const Face f = entry.face;
            if (chart[f] < 0) { // another chart may have taken it since
                heaps_[c].pop();
                chart[f] = c;
                cost.take(f, c, entry.distance);
                offer_neighbours(f, c, cost, chart);
                if (++taken % update_every == 0)
                    progress.update(0.0);
            }
            tournament.set(c, key_of(c, cost, chart));
        }
    }

private:
    template <class Cost>
    GrowthKey key_of(Index c, Cost& cost, const std::vector<Index>& chart) {
        CandidateHeap& heap = heaps_[c];
        while (!heap.empty() && chart[heap.top().face] >= 0)
            heap.pop();
        return heap.empty() ? GrowthKey{} : cost.key(c, heap.top());
    }

    template <class Cost>
    void offer_neighbours(Face f, Index c, Cost& cost, const std::vector<Index>& chart) {
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge twin = mesh_.twin[h];
            if (twin < 0 || chart[twin / 3] >= 0)
                continue;
            if (!Cost::keeps_first_offer || is_first_offer(twin, c, chart))
                heaps_[c].push(cost.candidate(h, c));
        }
    }

    // A face was offered before if another neighbour of it is in the chart already.
    bool is_first_offer(HalfEdge twin, Index c, const std::vector<Index>& chart) const {
        for (const HalfEdge h : {Mesh::next(twin), Mesh::previous(twin)}) {
            const Index other = mesh_.twin[h];
            if (other >= 0 && other / 3 != mesh_.twin[twin] / 3 && chart[other / 3] == c)
                return false;
        }
        return true;
    }

    static constexpr Index update_every = 4096; // faces between two looks at the progress object

    const Mesh& mesh_;
    std::vector<CandidateHeap> heaps_;
};

} // namespace devseg::growth
