#include "devseg/methods/dcharts/closing_trials.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "devseg/judge/final_map.h"
#include "devseg/methods/dcharts/joined_turns.h"
#include "devseg/methods/dcharts/tuning.h"

namespace devseg::dcharts {

using judge::TrialEffort;
using judge::TrialMap;

namespace {

// L2 stretch on the coarse surface up to which it may be within the bound.
double coarse_bound(double l2) {
    return std::sqrt(1.0 + tuning.coarse_slack * (l2 * l2 - 1.0));
}

} // namespace

double length_of(const Mesh& mesh, const std::vector<Index>& edges) {
    double length = 0.0;
    for (const HalfEdge h : edges)
        length += mesh.edge_length(h);
    return length;
}

void ClosingTrials::prepare(const std::vector<std::uint8_t>& fixed, Progress& progress) {
    if (options_.coarse_trials && !coarse_ && CoarseTrials::pay(mesh_, draft_))
        coarse_.emplace(mesh_, draft_, fixed, options_.chart.l2, progress);
}

void ClosingTrials::attempt(const Closing& closing, Verdict& verdict,
                            const Progress& progress) const {
    if (verdict.refused) {
        verdict.fresh = verdict.confirmed = true;
        return;
    }
    TrialEffort effort;
    effort.wanted_l2 = bounds_of(closing.charts).l2;
    effort.give_up = true;
    effort.only_near = !verdict.whole && closing.opened.empty();
    effort.only_apart = options_.keep_corners;
    verdict.is_coarse = coarse_ && closing.opened.empty();
    verdict.coarse = {};
    // What saves no seam is not looked at.
    const auto [first, second] = closing.charts;
    effort.most_cut_length =
        (verdict.is_coarse ? saved_by(closing, 0.0, coarse_->map(first), coarse_->map(second))
                           : saved_by(closing, 0.0, draft_.map[first], draft_.map[second])) -
        tuning.negligible * std::sqrt(mesh_.total_area);
    if (verdict.is_coarse)
        effort.wanted_l2 = coarse_bound(effort.wanted_l2);
    if (verdict.is_coarse)
        try_coarse(closing, effort, {}, progress, verdict);
    else
        assess(closing, try_fine(closing, effort, {}, progress), verdict);
}

// From `turns`, or from the maps of the charts.
TrialMap ClosingTrials::try_fine(const Closing& closing, const TrialEffort& effort,
                                 std::vector<Vec2> turns, const Progress& progress) const {
    if (turns.empty())
        turns = joined_turns(mesh_, draft_, closing);
    return judge::try_chart(mesh_, united_faces(draft_, closing.charts), seam_without(closing),
                            effort, progress, turns);
}

void ClosingTrials::try_coarse(const Closing& closing, const TrialEffort& effort,
                               std::vector<Vec2> turns, const Progress& progress,
                               Verdict& verdict) const {
    verdict.coarse =
        coarse_->try_closing(closing, seam_without(closing), effort, std::move(turns), progress);
    assess(closing, verdict.coarse, coarse_->map(closing.charts.first),
           coarse_->map(closing.charts.second), verdict);
    verdict.added += verdict.hidden;
}

void ClosingTrials::assess(const Closing& closing, TrialMap map, Verdict& verdict) const {
    assess(closing, std::move(map), draft_.map[closing.charts.first],
           draft_.map[closing.charts.second], verdict);
}

void ClosingTrials::assess(const Closing& closing, TrialMap map, const TrialMap& a,
                           const TrialMap& b, Verdict& verdict) const {
    const bool is_join = closing.charts.first != closing.charts.second;
    verdict.added = map.excess() - a.excess() - (is_join ? b.excess() : 0.0);
    verdict.saved = saved_by(closing, map.cut_length, a, b);
    verdict.map = std::move(map);
    verdict.tried = verdict.fresh = true;
    verdict.confirmed = false;
}

double ClosingTrials::saved_by(const Closing& closing, double cut_length, const TrialMap& a,
                               const TrialMap& b) const {
    const bool is_join = closing.charts.first != closing.charts.second;
    return length_of(mesh_, closing.edges) - length_of(mesh_, closing.opened) - cut_length +
           a.cut_length + (is_join ? b.cut_length : 0.0);
}

std::vector<std::uint8_t> ClosingTrials::seam_without(const Closing& closing) const {
    std::vector<std::uint8_t> seam = draft_.seam;
    for (const HalfEdge h : left_border(mesh_, draft_, closing))
        seam[h] = seam[mesh_.twin[h]] = 1;
    for (const HalfEdge h : closing.edges)
        seam[h] = seam[mesh_.twin[h]] = 0;
    for (const HalfEdge h : closing.opened)
        seam[h] = seam[mesh_.twin[h]] = 1;
    return seam;
}

StretchBounds ClosingTrials::bounds_of(const Pair& pair) const {
    const TrialMap& a = draft_.map[pair.first];
    const TrialMap& b = draft_.map[pair.second];
    StretchBounds limit = options_.chart;
    limit.linf = std::max(limit.linf, tuning.like_spot * std::max(a.linf, b.linf));
    if (std::min(a.area, b.area) < options_.small_share * mesh_.total_area &&
        pair.first != pair.second) {
        limit.l2 = std::max({limit.l2, std::sqrt(a.l2_squared), std::sqrt(b.l2_squared)});
        limit.l2 = 1.0 + tuning.small_allowance * (limit.l2 - 1.0);
        limit.linf = 1.0 + tuning.small_allowance * (limit.linf - 1.0);
    }
    // Nobody cuts out a splinter: it may be as stretched as it likes, for it adds nothing.
    if (std::min(a.area, b.area) < tuning.negligible * mesh_.total_area)
        limit.linf = infinite;
    limit.l2 = std::min(limit.l2, options_.chart.hard_l2);
    limit.linf = std::min(limit.linf, options_.chart.hard_linf);
    return limit;
}

// Final maps push overlapping parts apart themselves: before them it is looked at on the coarse
// surface alone, where there is one, whether that will do.
void ClosingTrials::confirm(const Closing& closing, Verdict& verdict, Progress& progress) const {
    TrialEffort apart;
    apart.wanted_l2 = bounds_of(closing.charts).l2;
    apart.push_apart = !options_.keep_corners;
    const bool was_overlapping = verdict.map.overlaps;
    const double expected = verdict.added - verdict.hidden;
    if (verdict.is_coarse && was_overlapping && options_.confirm) {
        apart.wanted_l2 = coarse_bound(apart.wanted_l2);
        try_coarse(closing, apart, verdict.coarse.turns, progress, verdict);
        verdict.map.flat = verdict.map.flat && !verdict.map.overlaps;
    } else if (verdict.map.flat && (verdict.is_coarse || was_overlapping)) {
        apart.give_up = verdict.is_coarse;
        apart.push_apart = apart.push_apart && (!verdict.is_coarse || !options_.confirm);
        TrialMap map = try_fine(
            closing, apart, verdict.is_coarse ? std::vector<Vec2>() : verdict.map.turns, progress);
        map.flat = map.flat && (!map.overlaps || (verdict.is_coarse && options_.confirm));
        assess(closing, std::move(map), verdict);
    }
    if (options_.confirm && verdict.map.flat &&
        (was_overlapping || bounds_of(closing.charts).hold(verdict.map))) {
        auto judging = progress.part(0.0);
        const std::vector<std::vector<Index>> chart{united_faces(draft_, closing.charts)};
        const std::vector<std::uint8_t> seam = seam_without(closing);
        TrialMap map = (options_.purpose == judge::MapFor::cloth
                            ? judge::final_maps(mesh_, chart, seam, judging, options_.purpose)
                            : judge::whole_maps(mesh_, chart, seam,
                                                {bounds_of(closing.charts).l2, true}, judging))
                           .front();
        map.cut_length = verdict.map.cut_length;
        assess(closing, std::move(map), verdict);
        verdict.refused = !verdict.map.flat || !bounds_of(closing.charts).hold(verdict.map);
    }
    if (verdict.is_coarse && verdict.map.flat)
        verdict.hidden = std::max(0.0, verdict.added - expected);
    verdict.confirmed = true;
}

bool ClosingTrials::holds(const Closing& closing, const Verdict& verdict) const {
    StretchBounds bounds = bounds_of(closing.charts);
    if (verdict.is_coarse && !verdict.confirmed) {
        bounds.linf = bounds.strain = infinite;
        bounds.l2 = coarse_bound(bounds.l2);
    }
    return bounds.hold(verdict.map);
}

bool ClosingTrials::close(const Closing& closing, const Verdict& verdict) {
    const bool is_anew = coarse_ && !verdict.is_coarse;
    if (is_anew)
        coarse_.reset();
    else if (coarse_)
        coarse_->close(closing.charts, verdict.coarse);
    return is_anew;
}

} // namespace devseg::dcharts
