#include "devseg/methods/dcharts/joins.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "devseg/base/parallel.h"
#include "devseg/methods/dcharts/closing_trials.h"
#include "devseg/methods/dcharts/cut_exchange.h"
#include "devseg/methods/dcharts/seam_chains.h"
#include "devseg/methods/dcharts/tuning.h"

namespace devseg::dcharts {

namespace {

using judge::TrialMap;
using Verdicts = std::map<std::vector<Index>, std::pair<Closing, Verdict>>; // by edges, ascending

class Joining {
public:
    Joining(const Mesh& mesh, const MergeOptions& options, Draft& draft)
        : mesh_(mesh), options_(options), draft_(draft), chains_(mesh, options.keep_corners),
          trials_(mesh, options, draft), open_(options.open) {}

    void run(Progress& progress) {
        const auto start = static_cast<double>(draft_.charts_number());
        const Index joins_before = draft_.joins;
        proposed_ = false; // the bounds may be others
        while (draft_.charts_number() > options_.enough_charts) {
            auto trying = progress.part(0.0); // joins say how far it is
            Entry* best = nullptr;
            do {
                trials_.prepare(chains_.corners(), trying);
                try_promising(trying);
                best = choose(progress);
                if (best == nullptr && try_old_again(trying))
                    best = choose(progress);
            } while (is_any_promising(best)); // what seemed the best is not
            const bool may_part = draft_.charts_number() > options_.parts_above;
            if (best != nullptr)
                close(best->first, best->second);
            else if (!may_part || (partly_ && (exchanging_ || !options_.exchange_cuts)))
                return;
            proposed_ = false;
            exchanging_ = exchanging_ || (partly_ && best == nullptr);
            partly_ = may_part && (partly_ || best == nullptr);
            progress.update((draft_.joins - joins_before) / start);
        }
    }

private:
    using Entry = std::pair<Closing, Verdict>;

    // All closings that there are now, those known with their verdicts.
    void propose(const Progress& progress) {
        if (proposed_)
            return;
        proposed_ = true;
        std::map<Pair, std::vector<Closing>> chains;
        std::vector<Closing> found = chains_.find(draft_);
        seams_at_corner_.clear();
        for (const Closing& chain : found)
            count_at_corners(chain, seams_at_corner_);
        for (Closing& chain : found)
            if (is_open(chain.charts.first) || is_open(chain.charts.second))
                chains[chain.charts].push_back(std::move(chain));
        Verdicts last = std::move(verdicts_);
        verdicts_.clear();
        untried_.clear();
        for (auto& [charts, parts] : chains) {
            if (charts.first != charts.second) {
                Closing whole{charts, {}, {}};
                for (const Closing& part : parts)
                    whole.edges.insert(whole.edges.end(), part.edges.begin(), part.edges.end());
                add(std::move(whole), true, last);
            }
            for (const Closing& part : parts)
                if (partly_)
                    add_parts(part, last);
            if (exchanging_ && charts.first == charts.second)
                for (Closing& part : parts) {
                    part.opened = shorter_cut(mesh_, draft_, part, progress);
                    if (!part.opened.empty())
                        add(std::move(part), false, last);
                }
        }
    }

    // A chain, and from both ends the longest of its halves, quarters and so on that can be closed.
    void add_parts(Closing chain, Verdicts& last) {
        add(chain, false, last);
        begin_loop_at(
            mesh_, [&](Vertex v) { return trials_.has(v); }, chain.edges);
        const double least = tuning.least_part * std::sqrt(mesh_.total_area);
        const double excess = draft_.excess();
        for (const bool at_end : {false, true})
            for (std::size_t count = chain.edges.size() / 2; count > 0; count /= 2) {
                count = up_to_kept_vertex(chain.edges, at_end, count);
                const auto begin = at_end ? chain.edges.end() - static_cast<std::ptrdiff_t>(count)
                                          : chain.edges.begin();
                Closing part{chain.charts, {begin, begin + static_cast<std::ptrdiff_t>(count)}, {}};
                if (length_of(mesh_, part.edges) < least)
                    break;
                const Entry* entry = add(std::move(part), false, last);
                if (entry == nullptr || price(*entry, excess) < infinite)
                    break;
            }
    }

    // Fewer edges from an end of a chain, up to a vertex that the coarse surface has.
    std::size_t up_to_kept_vertex(const std::vector<Index>& edges, bool at_end,
                                  std::size_t count) const {
        const auto is_kept = [&](std::size_t n) {
            return trials_.has(vertex_between(mesh_, edges[at_end ? edges.size() - n : n - 1],
                                              edges[at_end ? edges.size() - n - 1 : n]));
        };
        while (count > 0 && !is_kept(count))
            --count;
        return count;
    }

    // Returns what is known of it.
    const Entry* add(Closing closing, bool whole, Verdicts& last) {
        std::vector<Index> key = closing.edges;
        key.insert(key.end(), closing.opened.begin(), closing.opened.end());
        std::sort(key.begin(), key.end());
        if (encloses_corner(closing))
            return nullptr;
        const auto known = last.find(key);
        const bool is_known = known != last.end();
        const auto [entry, is_new] =
            verdicts_.try_emplace(std::move(key), std::move(closing),
                                  is_known ? std::move(known->second.second) : Verdict());
        if (is_new)
            entry->second.second.whole = whole;
        if (is_known && entry->second.second.tried)
            return &entry->second;
        if (is_new)
            untried_.push_back(&entry->second);
        return nullptr;
    }

    void count_at_corners(const Closing& closing, std::map<Index, int>& count) const {
        for (const HalfEdge h : closing.edges)
            for (const Vertex v : {mesh_.origin(h), mesh_.target(h)})
                if (chains_.is_corner(v))
                    ++count[v];
    }

    // Whether no seam leads to some corner any more: around it the surface is no plane.
    bool encloses_corner(const Closing& closing) const {
        std::map<Index, int> closed;
        count_at_corners(closing, closed);
        return std::any_of(closed.begin(), closed.end(), [&](const auto& corner) {
            return seams_at_corner_.at(corner.first) == corner.second;
        });
    }

    bool is_open(Index chart) const { return open_.empty() || open_[at(chart)] != 0; }

    // Tries what may be better than the best closing known, a few at a time: what they find makes
    // most of the others needless.
    void try_promising(Progress& progress) {
        for (bool found = true; found;) {
            found = false;
            propose(progress);
            for (auto few = most_promising(); !few.empty(); few = most_promising()) {
                try_again(few, progress);
                found = partly_;
            }
        }
    }

    std::vector<Entry*> most_promising() {
        const double excess = draft_.excess();
        double best = infinite;
        for (const auto& item : verdicts_)
            best = std::min(best, price(item.second, excess));
        std::vector<std::pair<double, Entry*>> order;
        for (Entry* entry : untried_)
            if (const double least = least_price(entry->first);
                !entry->second.tried && least <= best && least < infinite)
                order.emplace_back(least, entry);
        std::stable_sort(order.begin(), order.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
        order.resize(std::min(order.size(), tuning.tried_at_once));
        std::vector<Entry*> few;
        for (const auto& item : order)
            few.push_back(item.second);
        return few;
    }

    bool is_any_promising(const Entry* best) const {
        const double known = best != nullptr ? price(*best, draft_.excess()) : infinite;
        return std::any_of(untried_.begin(), untried_.end(), [&](const Entry* entry) {
            const double least = least_price(entry->first);
            return !entry->second.tried && least <= known && least < infinite;
        });
    }

    void try_again(const std::vector<Entry*>& entries, Progress& progress) {
        proposed_ = proposed_ && (entries.empty() || !partly_);
        parallel_for(
            static_cast<int>(entries.size()),
            [&](int i) {
                auto& [closing, verdict] = *entries[at(i)];
                trials_.attempt(closing, verdict, progress);
            },
            progress);
    }

    // Whole borders with old verdicts. False where there is none.
    bool try_old_again(Progress& progress) {
        std::vector<Entry*> old;
        for (auto& item : verdicts_)
            if (item.second.second.whole && !item.second.second.fresh &&
                least_price(item.second.first) < infinite)
                old.push_back(&item.second);
        try_again(old, progress);
        return !old.empty();
    }

    // Stretch for each length of seam that the closing saves; infinite where it may not be.
    double price(const Entry& entry, double excess) const {
        const auto& [closing, verdict] = entry;
        const bool may_overlap = !options_.keep_corners;
        if (!verdict.map.flat || (verdict.map.overlaps && !may_overlap) ||
            !trials_.holds(closing, verdict) || !(excess + verdict.added <= options_.max_excess) ||
            !is_worth(closing.charts, verdict.saved))
            return infinite;
        return price_of(verdict.added, verdict.saved);
    }

    double price_of(double added, double saved) const {
        return (std::max(0.0, added) + tuning.negligible * mesh_.total_area) / saved;
    }

    // No trial finds a lower price: as if the map added no stretch, and needed no cut.
    double least_price(const Closing& closing) const {
        const auto [first, second] = closing.charts;
        const double saved = length_of(mesh_, closing.edges) + draft_.map[first].cut_length +
                             (first != second ? draft_.map[second].cut_length : 0.0);
        return is_worth(closing.charts, saved) ? price_of(0.0, saved) : infinite;
    }

    // Whether it saves enough seam.
    bool is_worth(const Pair& pair, double saved) const {
        const double smaller = std::min(draft_.map[pair.first].area, draft_.map[pair.second].area);
        const double least =
            pair.first == pair.second ? 0.0 : options_.least_neck * std::sqrt(smaller);
        return saved > tuning.negligible * std::sqrt(mesh_.total_area) && !(saved < least);
    }

    // The seam that is bought off at the lowest price, none if there is none. Overlaps are worth
    // resolving only here, and only for whole borders of smooth charts: there are not many of
    // these, and pushing apart bends them little.
    Entry* choose(Progress& progress) {
        while (true) {
            const double excess = draft_.excess();
            std::vector<std::pair<double, Entry*>> order;
            for (auto& item : verdicts_)
                if (const double p = price(item.second, excess); p < infinite)
                    order.emplace_back(p, &item.second);
            const std::size_t few = std::min(tuning.tried_again, order.size());
            // Equals in the order of their edges.
            std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(few),
                              order.end(), [](const auto& a, const auto& b) {
                                  return a.first != b.first
                                             ? a.first < b.first
                                             : a.second->first.edges < b.second->first.edges;
                              });
            if (order.empty())
                return nullptr;
            auto& [closing, verdict] = *order.front().second;
            if (!verdict.fresh) {
                std::vector<Entry*> stale;
                for (std::size_t i = 0; i < few; ++i)
                    if (!order[i].second->second.fresh)
                        stale.push_back(order[i].second);
                auto trying = progress.part(0.0);
                try_again(stale, trying);
            } else if (trials_.is_sure(verdict)) {
                return order.front().second;
            } else {
                trials_.confirm(closing, verdict, progress);
                proposed_ = proposed_ && !partly_;
            }
        }
    }

    void close(const Closing& closing, const Verdict& verdict) {
        const auto [a, b] = closing.charts;
        draft_.seam = trials_.seam_without(closing);
        const std::vector<HalfEdge> left = left_border(mesh_, draft_, closing);
        draft_.left.insert(draft_.left.end(), left.begin(), left.end());
        draft_.left.insert(draft_.left.end(), closing.opened.begin(), closing.opened.end());
        chains_.open(closing.opened);
        draft_.map[a] = verdict.map;
        const bool is_anew = trials_.close(closing, verdict);
        if (!open_.empty())
            open_[at(a)] = open_[at(b)] = 1;
        if (a != b) {
            draft_.faces[a] = united_faces(draft_, closing.charts);
            for (const Face f : draft_.faces[b])
                draft_.chart[f] = a;
            draft_.faces[b].clear();
            ++draft_.joins;
        }
        for (auto& [edges, entry] : verdicts_) {
            const auto [first, second] = entry.first.charts;
            if (first == a || second == a || first == b || second == b || is_anew)
                entry.second.fresh = false;
        }
    }

    const Mesh& mesh_;
    const MergeOptions& options_;
    Draft& draft_;
    SeamChains chains_;
    ClosingTrials trials_;
    std::vector<std::uint8_t> open_; // of each chart; empty: all
    // Only which parts of borders there are depends on what trials of others gave.
    bool proposed_ = false;   // all closings that there are now are known
    bool partly_ = false;     // parts of borders are closed as well
    bool exchanging_ = false; // cuts are tried in other places as well
    Verdicts verdicts_;
    std::vector<Entry*> untried_;
    std::map<Index, int> seams_at_corner_; // seam edges at each corner that has any
};

} // namespace

void merge_charts(const Mesh& mesh, const MergeOptions& options, Draft& draft, Progress& progress) {
    Joining(mesh, options, draft).run(progress);
}

std::vector<Draft> merge_charts_in_steps(const Mesh& mesh, MergeOptions options,
                                         const std::vector<double>& max_excess, Draft draft,
                                         Progress& progress) {
    std::vector<Draft> drafts;
    Joining joining(mesh, options, draft);
    for (const double most : max_excess) {
        options.max_excess = most;
        auto step = progress.part(0.5 * progress.left());
        joining.run(step);
        drafts.push_back(draft);
    }
    return drafts;
}

} // namespace devseg::dcharts
