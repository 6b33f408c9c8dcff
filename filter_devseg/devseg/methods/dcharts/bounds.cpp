#include "devseg/methods/dcharts/bounds.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "devseg/base/parallel.h"
#include "devseg/judge/final_map.h"
#include "devseg/mesh/coarsen.h"
#include "devseg/methods/dcharts/full_charts.h"
#include "devseg/methods/dcharts/tuning.h"

namespace devseg::dcharts {

namespace {

using judge::TrialMap;

class BoundKeeping {
public:
    BoundKeeping(const Mesh& mesh, const FinalBounds& bounds, const DChartsOptions& growing,
                 const MergeOptions& merging, DevelopableCharts& charts)
        : mesh_(mesh), bounds_(bounds), growing_(growing), merging_(merging), charts_(charts),
          draft_(make_untried_draft(mesh, charts.chart)) {
        draft_.seam = charts.seam;
        draft_.map.assign(draft_.faces.size(), {});
        resize();
    }

    bool run(Progress& progress) {
        while (true) {
            auto judging = progress.part(0.2 * progress.left());
            judge_unknown(bounds_.linf == 0.0 && bounds_.strain == 0.0 &&
                              bounds_.max_excess == infinite,
                          judging);
            const std::vector<Index> above = charts_above();
            if (!bounds_.may_cut) {
                hand_back();
                return above.empty();
            }
            auto cutting = progress.part(0.2 * progress.left());
            bool changed = false;
            for (const Index c : above)
                changed |= take_down(c, cutting);
            if (!changed)
                break;
        }
        join_again(progress);
        hand_back();
        return !any_touched();
    }

private:
    enum class Known : std::uint8_t { nothing, within, map };

    void resize() {
        known_.resize(draft_.faces.size(), Known::nothing);
        touched_.resize(draft_.faces.size(), 0);
        darted_.resize(draft_.faces.size(), 0);
        whole_.resize(draft_.faces.size(), 0);
    }

    // By the bound that costs little where that is enough, and by their final maps.
    void judge_unknown(bool quick, Progress& progress) {
        std::vector<Index> unknown;
        for (Index c = 0; c < static_cast<Index>(draft_.faces.size()); ++c)
            if (!draft_.faces[c].empty() && known_[c] == Known::nothing)
                unknown.push_back(c);
        if (quick && bounds_.chart_l2 > 0.0) {
            auto looking = progress.part("judging charts", 0.3);
            // Rough charts are measured: those above their bound are told.
            const double sure =
                std::min(std::sqrt(1.0 + allowed_excess(tuning.certain)), bounds_.chart_l2);
            parallel_for(
                static_cast<int>(unknown.size()),
                [&](int i) {
                    const Index c = unknown[at(i)];
                    if (judge::is_surely_within(mesh_, draft_.faces[c], draft_.seam, sure, looking))
                        known_[c] = Known::within;
                },
                looking);
        }
        auto judging = progress.part("judging charts", 1.0);
        std::vector<Index> open;
        for (const Index c : unknown)
            if (known_[c] == Known::nothing)
                open.push_back(c);
        measure(open, judging);
    }

    void measure(const std::vector<Index>& which, Progress& progress) {
        std::vector<std::vector<Index>> faces;
        for (const Index c : which)
            faces.push_back(draft_.faces[c]);
        std::vector<TrialMap> maps =
            judge::final_maps(mesh_, faces, draft_.seam, progress, bounds_.purpose());
        for (std::size_t i = 0; i < which.size(); ++i) {
            draft_.map[which[i]] = std::move(maps[i]);
            known_[which[i]] = Known::map;
        }
    }

    // Within its bound to the last digit, or named.
    Standing standing(Index c) const {
        if (is_above(c, 1.0))
            return Standing::above;
        const TrialMap& map = draft_.map[c];
        StretchBounds smooth;
        smooth.l2 = bounds_.chart_l2 > 0.0 ? bounds_.chart_l2 : infinite;
        smooth.linf = infinite;
        smooth.strain = bounds_.strain > 0.0 ? bounds_.strain : infinite;
        return known_[c] == Known::map && !smooth.hold(map) ? Standing::rough : Standing::kept;
    }

    // l2² − 1 that a chart may use of this share of its bound. Roughness counts apart.
    double allowed_excess(double share) const {
        return share * (bounds_.chart_l2 * bounds_.chart_l2 - 1.0) + bounds_.roughness;
    }

    bool is_above(Index c, double share) const {
        const TrialMap& map = draft_.map[c];
        StretchBounds strained;
        strained.strain = bounds_.allowed_strain(share);
        return known_[c] == Known::map &&
               ((bounds_.chart_l2 > 0.0 && map.l2_squared - 1.0 > allowed_excess(share)) ||
                (bounds_.linf > 0.0 && map.linf > bounds_.linf) || !strained.keep_strain(map));
    }

    // Those above their own bound; and, while all together are above theirs, those that add most.
    std::vector<Index> charts_above() const {
        std::vector<Index> above;
        std::vector<std::pair<double, Index>> rest;
        double excess = 0.0;
        for (Index c = 0; c < static_cast<Index>(draft_.faces.size()); ++c) {
            if (draft_.faces[c].empty() || whole_[c] != 0)
                continue;
            if (is_above(c, tuning.certain) || !draft_.map[c].part.empty()) {
                above.push_back(c);
            } else {
                excess += draft_.map[c].excess();
                rest.emplace_back(-draft_.map[c].excess(), c);
            }
        }
        if (draft_.excess() <= bounds_.max_excess)
            return above;
        std::sort(rest.begin(), rest.end());
        for (std::size_t i = 0; i < rest.size() && excess > tuning.certain * bounds_.max_excess;
             ++i) {
            above.push_back(rest[i].second);
            excess += rest[i].first;
        }
        return above;
    }

    // Parts that flattening cuts apart become charts. Else darts first; then the chart is split.
    bool take_down(Index c, Progress& progress) {
        const std::size_t before = draft_.faces.size();
        if (!draft_.map[c].part.empty()) {
            divide(c);
            return true;
        }
        if (bounds_.add_darts && darted_[c] == 0 && cut_darts(c, progress)) {
            darted_[c] = touched_[c] = 1;
            known_[c] = Known::nothing;
            return true;
        }
        const double l2 = bounds_.chart_l2 > 0.0 ? bounds_.chart_l2 : 1.0;
        if (!split_chart(mesh_, growing_, l2, c, draft_, progress) &&
            !halve_chart(mesh_, l2, c, draft_, progress)) {
            whole_[c] = 1;
            return false;
        }
        resize();
        known_[c] = Known::nothing;
        touched_[c] = 1;
        darted_[c] = 0;
        for (std::size_t n = before; n < draft_.faces.size(); ++n)
            touched_[n] = 1;
        return true;
    }

    // The first part keeps the number.
    void divide(Index c) {
        const std::vector<Index> part = std::move(draft_.map[c].part);
        const std::vector<Index> faces = std::move(draft_.faces[c]);
        const Index first_new = static_cast<Index>(draft_.faces.size()) - 1;
        draft_.faces[c].clear();
        draft_.faces.resize(draft_.faces.size() + at(*std::max_element(part.begin(), part.end())));
        draft_.map.resize(draft_.faces.size());
        resize();
        for (std::size_t i = 0; i < faces.size(); ++i) {
            const Index to = part[i] == 0 ? c : first_new + part[i];
            draft_.chart[faces[i]] = to;
            draft_.faces[to].push_back(faces[i]);
            touched_[to] = 1;
        }
        draft_.map[c] = {};
        known_[c] = Known::nothing;
    }

    // On a coarse version of the chart. False where that does not bring it within its bounds.
    bool cut_darts(Index c, Progress& progress) {
        if (!is_above(c, tuning.certain))
            return false;
        const atlas::ChartSurface surface = atlas::extract_surface(
            mesh_, draft_.faces[c], atlas::enclose(mesh_, draft_.faces[c], draft_.seam));
        const Mesh part = atlas::mesh_of(mesh_, surface);
        const auto decimation = decimate(part, false, 1, progress);
        const Mesh& coarse = decimation ? decimation->mesh : part;
        DartOptions darts;
        darts.max_per_chart = tuning.few_darts;
        darts.worth = 0.0;
        darts.chart.l2 = bounds_.chart_l2 > 0.0 ? bounds_.chart_l2 : infinite;
        darts.chart.linf = bounds_.linf > 0.0 ? bounds_.linf : infinite;
        darts.chart.strain = bounds_.allowed_strain(tuning.certain);
        Draft draft = make_draft(coarse, std::vector<Index>(coarse.faces.size(), 0), {},
                                 bounds_.chart_l2, progress);
        dcharts::cut_darts(coarse, darts, draft, progress);
        if (draft.tips.empty() || !darts.chart.hold(draft.map.front()))
            return false;
        std::vector<Index> tips = draft.tips;
        for (Index& tip : tips)
            tip = decimation ? decimation->vertex[tip] : tip;
        std::vector<std::uint8_t> seam(part.twin.size(), 0);
        charts_.darts += cut_darts_to(part, std::vector<Index>(part.faces.size(), 0), tips, seam);
        for (const HalfEdge h : part.all_half_edges())
            if (seam[h] != 0)
                draft_.seam[surface.mesh_half_edge(h)] = 1;
        return true;
    }

    void join_again(Progress& progress) {
        if (!merging_.confirm || !any_touched())
            return;
        std::vector<Index> beside; // of the charts that were cut, and themselves
        for (Index c = 0; c < static_cast<Index>(draft_.faces.size()); ++c)
            if (known_[c] != Known::map && is_beside_touched(c))
                beside.push_back(c);
        auto measuring = progress.part(0.2);
        measure(beside, measuring);
        MergeOptions merging = merging_;
        if (bounds_.chart_l2 > 0.0)
            merging.chart.hard_l2 = std::sqrt(1.0 + allowed_excess(tuning.certain));
        merging.chart.strain = bounds_.allowed_strain(tuning.certain);
        merging.purpose = bounds_.purpose();
        merging.open = touched_;
        auto joining = progress.part("joining charts", 1.0);
        merge_charts(mesh_, merging, draft_, joining);
    }

    bool any_touched() const {
        return std::any_of(touched_.begin(), touched_.end(), [](auto t) { return t != 0; });
    }

    bool is_beside_touched(Index c) const {
        for (const Face f : draft_.faces[c])
            for (const HalfEdge h : half_edges_of(f))
                if (mesh_.twin[h] >= 0 && touched_[draft_.chart[mesh_.across(h)]] != 0)
                    return true;
        return false;
    }

    void hand_back() {
        charts_.joins += draft_.joins;
        charts_.seam = draft_.seam;
        charts_.chart = atlas::make_chart_map(mesh_, draft_.chart, charts_.seam, false).chart;
        for (Index c = 0; c < static_cast<Index>(draft_.faces.size()); ++c)
            for (const Face f : draft_.faces[c])
                charts_.standing[f] = standing(c);
        charts_.strain = {};
        for (std::size_t c = 0; c < draft_.map.size(); ++c)
            if (!draft_.faces[c].empty())
                charts_.strain.take_worse(draft_.map[c].strain);
        if (bounds_.max_excess == infinite && bounds_.linf == 0.0)
            return;
        charts_.l2_stretch = std::sqrt(1.0 + std::max(0.0, draft_.excess()) / mesh_.total_area);
        charts_.linf_stretch = 1.0;
        for (std::size_t c = 0; c < draft_.map.size(); ++c)
            if (!draft_.faces[c].empty())
                charts_.linf_stretch = std::max(charts_.linf_stretch, draft_.map[c].linf);
    }

    const Mesh& mesh_;
    const FinalBounds& bounds_;
    const DChartsOptions& growing_;
    const MergeOptions& merging_;
    DevelopableCharts& charts_;
    Draft draft_; // of the full surface, with final maps
    std::vector<Known> known_;
    std::vector<std::uint8_t> touched_; // of each chart: was cut here
    std::vector<std::uint8_t> darted_;
    std::vector<std::uint8_t> whole_; // cannot be split
};

} // namespace

double FinalBounds::allowed_strain(double share) const {
    return strain > 0.0 ? share * strain + tuning.rough_tail * std::sqrt(roughness) : infinite;
}

bool keep_bounds(const Mesh& mesh, const FinalBounds& bounds, const DChartsOptions& growing,
                 const MergeOptions& merging, DevelopableCharts& charts, Progress& progress) {
    return BoundKeeping(mesh, bounds, growing, merging, charts).run(progress);
}

} // namespace devseg::dcharts
