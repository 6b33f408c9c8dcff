#include "devseg/methods/dcharts/merging.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "devseg/base/parallel.h"

namespace devseg::dcharts {

namespace {

// Stretch that equal lengths of border are worth when two joins cost next to nothing: a share of
// the area for each √area of border.
constexpr double negligible = 1e-5;

class Merger {
public:
    Merger(const Mesh& mesh, const MergeOptions& options, Draft& draft, Progress& progress)
        : mesh_(mesh), options_(options), draft_(draft), progress_(progress) {}

    Index run() {
        Index joins = 0;
        while (true) {
            measure_borders();
            try_new_pairs();
            const Pair best = choose();
            if (best.first < 0)
                return joins;
            join(best);
            ++joins;
            progress_.update(static_cast<double>(joins) / static_cast<double>(draft_.faces.size()));
        }
    }

private:
    using Pair = std::pair<Index, Index>;

    void measure_borders() {
        length_.clear();
        for (const HalfEdge h : mesh_.all_half_edges()) {
            const HalfEdge twin = mesh_.twin[h];
            if (twin > h && draft_.chart[h / 3] != draft_.chart[twin / 3])
                length_[std::minmax(draft_.chart[h / 3], draft_.chart[twin / 3])] +=
                    mesh_.edge_length(h);
        }
    }

    std::vector<Index> united(const Pair& pair) const {
        const std::vector<Index>& a = draft_.faces[pair.first];
        const std::vector<Index>& b = draft_.faces[pair.second];
        std::vector<Index> faces(a.size() + b.size());
        std::merge(a.begin(), a.end(), b.begin(), b.end(), faces.begin());
        return faces;
    }

    // Stretch up to which a joined chart may be worth having.
    StretchBounds bounds(const Pair& pair) const {
        StretchBounds limit = options_.chart;
        for (const Index c : {pair.first, pair.second})
            limit.linf = std::max(limit.linf, draft_.map[c].linf);
        if (is_small(pair.first) || is_small(pair.second)) {
            const judge::TrialMap& a = draft_.map[pair.first];
            const judge::TrialMap& b = draft_.map[pair.second];
            limit.l2 = std::max({limit.l2, std::sqrt(a.l2_squared), std::sqrt(b.l2_squared)});
            limit.l2 = 1.0 + small_allowance * (limit.l2 - 1.0);
            limit.linf = 1.0 + small_allowance * (limit.linf - 1.0);
        }
        return limit;
    }
    bool is_small(Index c) const {
        return draft_.map[c].area < options_.small_share * mesh_.total_area;
    }

    void try_new_pairs() {
        std::vector<Pair> open;
        for (const auto& [pair, length] : length_)
            if (joined_.count(pair) == 0)
                open.push_back(pair);
        std::vector<judge::TrialMap> maps(open.size());
        parallel_for(
            static_cast<int>(open.size()),
            [&](int i) {
                const Pair& pair = open[static_cast<std::size_t>(i)];
                judge::TrialEffort effort;
                effort.wanted_l2 = bounds(pair).l2;
                effort.give_up = true;
                maps[static_cast<std::size_t>(i)] =
                    judge::try_chart(mesh_, united(pair), draft_.seam, effort, progress_);
            },
            progress_);
        for (std::size_t i = 0; i < open.size(); ++i)
            joined_[open[i]] = maps[i];
    }

    double added_excess(const Pair& pair, const judge::TrialMap& map) const {
        return map.excess() - draft_.map[pair.first].excess() - draft_.map[pair.second].excess();
    }

    bool is_allowed(const Pair& pair, const judge::TrialMap& map, double excess) const {
        return map.flat && bounds(pair).hold(map) &&
               excess + added_excess(pair, map) <= options_.max_excess;
    }

    double least_border(const Pair& pair) const {
        const double area = std::min(draft_.map[pair.first].area, draft_.map[pair.second].area);
        return options_.least_neck * std::sqrt(area);
    }

    // The pair whose border is bought off at the lowest price; −1 if there is none.
    Pair choose() {
        const double excess = draft_.excess();
        while (true) {
            Pair best(-1, -1);
            double lowest = infinite;
            for (const auto& [pair, length] : length_) {
                const judge::TrialMap& map = joined_[pair];
                const double saved = length - map.cut_length + draft_.map[pair.first].cut_length +
                                     draft_.map[pair.second].cut_length;
                if (!is_allowed(pair, map, excess) || !(saved > 0.0) || saved < least_border(pair))
                    continue;
                const double price =
                    (std::max(0.0, added_excess(pair, map)) + negligible * mesh_.total_area) /
                    saved;
                if (price < lowest) {
                    lowest = price;
                    best = pair;
                }
            }
            if (best.first < 0 || !joined_[best].overlaps)
                return best;
            judge::TrialEffort effort;
            effort.wanted_l2 = bounds(best).l2;
            effort.push_apart = true;
            judge::TrialMap& map = joined_[best];
            map = judge::try_chart(mesh_, united(best), draft_.seam, effort, progress_);
            map.flat = map.flat && !map.overlaps;
        }
    }

    void join(const Pair& pair) {
        const auto [a, b] = pair;
        for (const Face f : draft_.faces[b])
            draft_.chart[f] = a;
        draft_.faces[a] = united(pair);
        draft_.faces[b].clear();
        draft_.map[a] = joined_[pair];
        for (auto it = joined_.begin(); it != joined_.end();) {
            const bool concerned = it->first.first == a || it->first.second == a ||
                                   it->first.first == b || it->first.second == b;
            it = concerned ? joined_.erase(it) : std::next(it);
        }
    }

    static constexpr double small_allowance = 3.0; // of small charts, over the bounds of others

    const Mesh& mesh_;
    const MergeOptions& options_;
    Draft& draft_;
    Progress& progress_;
    std::map<Pair, double> length_;          // of the border between two charts
    std::map<Pair, judge::TrialMap> joined_; // what the two would be as one chart
};

} // namespace

Index merge_charts(const Mesh& mesh, const MergeOptions& options, Draft& draft,
                   Progress& progress) {
    return Merger(mesh, options, draft, progress).run();
}

} // namespace devseg::dcharts
