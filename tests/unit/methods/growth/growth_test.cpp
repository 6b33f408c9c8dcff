#include "devseg/methods/growth/growth.h"

#include <algorithm>
#include <queue>
#include <tuple>

#include <gtest/gtest.h>

#include "unit/checks.h"
#include "unit/mesh_edits.h"
#include "unit/shapes.h"

namespace devseg::growth {
namespace {

using shapes::Random;

constexpr float infinity = std::numeric_limits<float>::infinity();

struct Later {
    bool operator()(const CandidateHeap::Entry& a, const CandidateHeap::Entry& b) const {
        return std::tie(a.key, a.face) > std::tie(b.key, b.face);
    }
};
using Reference =
    std::priority_queue<CandidateHeap::Entry, std::vector<CandidateHeap::Entry>, Later>;

TEST(CandidateHeap, AgreesWithAStandardQueue) {
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
        Random random(seed);
        const Index keys = 1 + random.below(500); // few of them: many ties
        CandidateHeap heap;
        Reference reference;
        for (Index step = 0; step < 4000; ++step) {
            // Phases of growing and of shrinking, down to empty and back.
            const bool push = random.below(100) < (step / 500 % 2 == 0 ? 70 : 30);
            if (push) {
                const CandidateHeap::Entry entry{static_cast<float>(random.below(keys)) - 100.0F,
                                                 static_cast<float>(step), step};
                heap.push(entry);
                reference.push(entry);
            } else if (!reference.empty()) {
                heap.pop();
                reference.pop();
            }
            ASSERT_EQ(heap.empty(), reference.empty());
            if (!reference.empty()) {
                ASSERT_EQ(heap.top().key, reference.top().key);
                ASSERT_EQ(heap.top().face, reference.top().face);
                ASSERT_EQ(heap.top().distance, reference.top().distance);
            }
        }
    }
}

TEST(CandidateHeap, SortsWhateverTheOrder) {
    Random random(5);
    for (Index count = 0; count < 40; ++count) {
        CandidateHeap heap;
        std::vector<float> keys;
        for (Index i = 0; i < count; ++i) {
            keys.push_back(static_cast<float>(random.uniform(-1.0, 1.0)));
            heap.push({keys.back(), 0.0F, i});
        }
        std::sort(keys.begin(), keys.end());
        for (const float key : keys) {
            ASSERT_FALSE(heap.empty());
            ASSERT_EQ(heap.top().key, key);
            heap.pop();
        }
        ASSERT_TRUE(heap.empty());
    }
}

TEST(CandidateHeap, ClearEmptiesIt) {
    CandidateHeap heap;
    heap.push({1.0F, 0.0F, 0});
    heap.clear();
    EXPECT_TRUE(heap.empty());
    heap.push({3.0F, 0.0F, 1});
    EXPECT_EQ(heap.top().face, 1);
}

TEST(Tournament, AgreesWithALinearSearch) {
    Random random(6);
    for (const Index players : {1, 2, 3, 4, 5, 7, 8, 9, 31, 64, 65, 200}) {
        Tournament tournament(players);
        std::vector<float> keys(at(players), infinity);
        for (int step = 0; step < 1000; ++step) {
            const Index player = random.below(players);
            // Few values, so that ties are common; infinity takes a player out.
            keys[player] =
                random.below(4) == 0 ? infinity : static_cast<float>(random.below(10) - 5);
            tournament.set(player, keys[player]);
            const Index winner = tournament.winner();
            const auto smallest = std::min_element(keys.begin(), keys.end());
            ASSERT_EQ(tournament.key(winner), *smallest);
            if (*smallest < infinity) {
                ASSERT_EQ(winner, smallest - keys.begin()); // ties: the lowest number
            }
            ASSERT_EQ(tournament.key(player), keys[player]);
        }
    }
}

TEST(Tournament, StartsWithoutCandidates) {
    for (const Index players : {1, 3, 16}) {
        const Tournament tournament(players);
        EXPECT_EQ(tournament.key(tournament.winner()), infinity);
    }
}

struct EveryFace {
    const Mesh& mesh;

    CandidateHeap::Entry candidate(HalfEdge h, Index) const {
        return {1.0F, 1.0F, face_of(mesh.twin[h])};
    }
    float key(Index, const CandidateHeap::Entry& entry) const { return entry.key; }
    void take(Index, Index, float) const {}
};

TEST(MultiHeap, ReachesFacesBetweenThoseThatItBeginsWith) {
    const Mesh mesh = checks::gated(shapes::sphere(1));
    std::vector<Index> chart(mesh.faces.size(), 0);
    chart[7] = -1; // all its neighbours are in the chart from the start
    std::vector<Index> front;
    for (Index f = 0; f < mesh.face_count(); ++f)
        if (f != 7)
            front.push_back(f);
    EveryFace cost{mesh};
    MultiHeap<Offers::first>(mesh).spread(front, 1, cost, chart, Progress());
    EXPECT_EQ(chart[7], 0);
}

} // namespace
} // namespace devseg::growth
