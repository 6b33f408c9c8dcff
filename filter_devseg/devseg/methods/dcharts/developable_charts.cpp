#include "devseg/methods/dcharts/developable_charts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "devseg/atlas/fragments.h"
#include "devseg/methods/dcharts/coarse_charts.h"
#include "devseg/methods/dcharts/draft.h"
#include "devseg/methods/growth/expansion.h"

namespace devseg::dcharts {

namespace {

// What border is worth against the fitting error of faces.
constexpr double smooth_length_weight = 0.045;

// Where creases shape the surface, its parts are cones, cylinders and planes but for the
// tessellation: charts must fit them closely, borders belong on creases whatever their length, and
// joins must be nearly exact.
constexpr double creased_fitting_error = 0.008; // F_max at most
constexpr double creased_length_weight = 0.001;
constexpr double creased_threshold = 0.02; // factor of η

constexpr double bent_cosine = 0.866; // of 30 degrees
constexpr double sharp_cosine = 0.5;  // of 60 degrees
constexpr double sharp_share = 0.6;   // of the bent edges
constexpr double least_creases = 1.0; // over the root of the area

constexpr int few_seeds = 3;
constexpr int more_seeds = 6;       // where so few give more charts than were asked for
constexpr int automatic_seeds = 10; // where the number of charts is to be found
constexpr int most_splits = 200;
constexpr double room_for_joins = 0.6; // of the allowed stretch: splitting goes below it
constexpr int most_attempts = 5;
constexpr int most_linf_attempts = 2; // then charts are split until the worst spot is within it
constexpr double first_share = 0.9;   // of the allowed stretch that the coarse surface may use
constexpr double chart_excess = 4.0;  // of one chart over that of the whole
constexpr double loose_linf = 8.0;    // worst spots count little where they have no bound

// Stretch that joined charts may have, from η: at η = 0.01, L2 1.005 and L∞ 1.4.
StretchBounds bounds_from(double merge_threshold) {
    return {1.0 + 0.5 * merge_threshold, 1.0 + 4.0 * std::sqrt(merge_threshold)};
}

// Whether creases, rather than smooth or rough regions, give the surface its shape: then most edges
// that are not smooth are sharp.
bool is_creased(const Mesh& mesh) {
    double bent = 0.0;
    double sharp = 0.0;
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge twin = mesh.twin[h];
        if (twin <= h)
            continue;
        const double cosine = mesh.face_normals[h / 3].dot(mesh.face_normals[twin / 3]);
        bent += cosine < bent_cosine ? mesh.edge_length(h) : 0.0;
        sharp += cosine < sharp_cosine ? mesh.edge_length(h) : 0.0;
    }
    return sharp > least_creases * std::sqrt(mesh.total_area) && sharp > sharp_share * bent;
}

// One run: the surface on which decisions are made, and how charts grow on it.
class Designer {
public:
    Designer(const Mesh& mesh, const DevelopableChartsOptions& options, Progress& progress)
        : options_(options), creased_(is_creased(mesh)), growing_(options),
          working_(mesh, creased_, std::max(options.charts_number, automatic_seeds), progress) {
        if (options.charts_number == 0)
            growing_.charts_number = std::min(automatic_seeds, mesh.face_count());
        if (creased_)
            growing_.max_fitting_error = std::min(options.max_fitting_error, creased_fitting_error);
    }

    DevelopableCharts run(Progress& progress) {
        auto growing = progress.part(0.16);
        grow_patches(growing);
        auto deciding = progress.part(progress.left());
        return options_.charts_number == 0 ? run_automatic(deciding) : run_with_estimate(deciding);
    }

private:
    struct Aim {
        StretchBounds chart;
        double max_excess = infinite;
        bool few = false; // few charts matter more than wide necks between their parts
    };

    void grow_patches(Progress& progress) {
        const Mesh& mesh = working_.mesh();
        auto growing = progress.part(0.15);
        const DChartsResult grown = segment_dcharts(mesh, growing_, growing);
        result_.rounds = grown.rounds;
        result_.converged = grown.converged;
        result_.hole_charts = grown.hole_charts;
        patch_ = grown.chart;
        auto straightening = progress.part("straightening borders", 0.85);
        if (options_.straighten_boundaries) {
            growth::ExpansionOptions expansion;
            expansion.max_fitting_error = growing_.max_fitting_error;
            expansion.length_weight = creased_ ? creased_length_weight : smooth_length_weight;
            growth::relabel_by_expansion(mesh, grown.proxies, expansion, patch_, straightening);
        }
        patch_ = atlas::absorb_fragments(mesh, patch_, fragment_share);
    }

    DevelopableCharts run_with_estimate(Progress& progress) {
        if (!options_.merge_charts && !options_.add_darts)
            return finish(make_untried_draft(working_.mesh(), patch_), Straightening::smooth,
                          progress);
        Aim aim;
        aim.chart = bounds_from(options_.merge_threshold * (creased_ ? creased_threshold : 1.0));
        const bool few = options_.merge_charts && options_.charts_number <= few_seeds;
        auto trying = progress.part(few ? 0.5 : 0.95);
        Draft draft = try_patches(aim, trying);
        if (few && draft.charts_number() > options_.charts_number)
            begin_with_more(aim, draft, progress);
        return finish(draft, Straightening::smooth, progress);
    }

    Draft try_patches(const Aim& aim, Progress& progress) {
        auto trying = progress.part("trying charts", 0.07);
        Draft draft = make_draft(working_.mesh(), patch_, {}, aim.chart.l2, trying);
        auto improving = progress.part(0.93);
        improve(aim, draft, improving);
        return draft;
    }

    // What few seeds do not reach becomes charts of its own, of any shape: charts of more seeds may
    // be joined to fewer.
    void begin_with_more(const Aim& aim, Draft& draft, Progress& progress) {
        const std::vector<Index> patch = patch_;
        const DevelopableCharts result = result_;
        growing_.charts_number = std::min(more_seeds, working_.mesh().face_count());
        auto growing = progress.part(0.2 * progress.left());
        grow_patches(growing);
        auto trying = progress.part(0.9 * progress.left());
        Draft other = try_patches(aim, trying);
        if (other.charts_number() < draft.charts_number()) {
            draft = std::move(other);
        } else {
            patch_ = patch;
            result_ = result;
        }
    }

    void improve(const Aim& aim, Draft& draft, Progress& progress) {
        if (options_.merge_charts) {
            auto joining = progress.part("joining charts", options_.add_darts ? 0.75 : 1.0);
            MergeOptions merging;
            merging.chart = aim.chart;
            merging.max_excess = aim.max_excess;
            merging.least_neck = aim.few ? 0.0 : merging.least_neck;
            result_.joins = merge_charts(working_.mesh(), merging, draft, joining);
        }
        if (options_.add_darts) {
            auto cutting = progress.part("cutting darts", 1.0);
            DartOptions darts;
            darts.chart = aim.chart;
            cut_darts(working_.mesh(), darts, draft, cutting);
        }
    }

    // Splits the charts that contribute most until the stretch of all leaves room for joins.
    void split_worst(const Aim& aim, Draft& draft, Progress& progress) {
        std::vector<std::uint8_t> whole; // charts that could not be split
        for (int i = 0; i < most_splits && draft.excess() > room_for_joins * aim.max_excess; ++i) {
            whole.resize(draft.faces.size(), 0);
            Index worst = -1;
            for (Index c = 0; c < static_cast<Index>(draft.faces.size()); ++c)
                if (!draft.faces[c].empty() && whole[c] == 0 &&
                    (worst < 0 || draft.map[c].excess() > draft.map[worst].excess()))
                    worst = c;
            if (worst < 0)
                return;
            if (!split_chart(working_.mesh(), growing_, aim.chart.l2, worst, draft, progress))
                whole[worst] = 1;
        }
    }

    // The fewest charts within the bounds: what the coarse surface may use of them is lowered until
    // the map of the full surface keeps them.
    DevelopableCharts run_automatic(Progress& progress) {
        const double allowed = options_.max_l2_stretch * options_.max_l2_stretch - 1.0;
        const bool has_linf = options_.max_linf_stretch > 0.0;
        double share = first_share;
        double linf = has_linf ? options_.max_linf_stretch
                               : bounds_from(loose_linf * (options_.max_l2_stretch - 1.0)).linf;
        auto trying = progress.part("trying charts", 0.04);
        const Draft start =
            make_draft(working_.mesh(), patch_, {}, options_.max_l2_stretch, trying);
        DevelopableCharts best;
        const int attempts = has_linf ? most_linf_attempts : most_attempts;
        for (int attempt = 0; attempt < attempts; ++attempt) {
            Aim aim;
            aim.chart = {std::sqrt(1.0 + chart_excess * allowed), linf};
            aim.max_excess = share * allowed * working_.mesh().total_area;
            aim.few = true;
            Draft draft = start;
            auto trial = progress.part(0.5 * progress.left());
            auto splitting = trial.part("splitting charts", 0.04);
            split_worst(aim, draft, splitting);
            auto improving = trial.part(0.76);
            improve(aim, draft, improving);
            StretchBounds reached;
            for (const auto straightening : {Straightening::smooth, Straightening::fitting}) {
                auto finishing = trial.part(0.1);
                DevelopableCharts found =
                    finish_within_bounds(aim, draft, straightening, finishing);
                reached = {found.l2_stretch, found.linf_stretch};
                if (best.chart.empty() || distance(found) < distance(best))
                    best = std::move(found);
                if (best.bounds_kept)
                    return best;
            }
            share *= std::min(0.9, allowed / (reached.l2 * reached.l2 - 1.0));
            if (has_linf)
                linf = 1.0 + (linf - 1.0) * std::min(0.9, (options_.max_linf_stretch - 1.0) /
                                                              (reached.linf - 1.0));
        }
        if (has_linf && best.l2_stretch <= options_.max_l2_stretch) {
            const FinalStretch reached = working_.split_above(options_.max_linf_stretch, growing_,
                                                              best.chart, best.seam, progress);
            note_stretch(reached.all, best);
            best.fitting_error = working_.fitting_errors(best.chart);
        }
        return best;
    }

    // From isometry, in bounds: at most 1 where they are kept.
    double distance(const DevelopableCharts& charts) const {
        const auto excess = [](double stretch) { return stretch * stretch - 1.0; };
        const double l2 = excess(charts.l2_stretch) / excess(options_.max_l2_stretch);
        return options_.max_linf_stretch == 0.0
                   ? l2
                   : std::max(l2, excess(charts.linf_stretch) / excess(options_.max_linf_stretch));
    }

    // With more darts where the worst spot needs them, and measured.
    DevelopableCharts finish_within_bounds(const Aim& aim, const Draft& draft,
                                           Straightening straightening, Progress& progress) {
        auto finishing = progress.part(0.1);
        DevelopableCharts found = finish(draft, straightening, finishing);
        auto measuring = progress.part(0.6);
        note_stretch(working_.measure(found.chart, found.seam, measuring).all, found);
        if (options_.max_linf_stretch > 0.0 && options_.add_darts && !found.bounds_kept &&
            found.l2_stretch <= options_.max_l2_stretch) {
            DartOptions darts;
            darts.chart = {aim.chart.l2, options_.max_linf_stretch};
            auto cutting = progress.part("cutting darts", 0.1);
            found.darts += working_.cut_more_darts(darts, found.chart, found.seam, cutting);
            auto again = progress.part(0.1);
            note_stretch(working_.measure(found.chart, found.seam, again).all, found);
        }
        return found;
    }

    void note_stretch(const StretchBounds& reached, DevelopableCharts& charts) const {
        charts.l2_stretch = reached.l2;
        charts.linf_stretch = reached.linf;
        charts.bounds_kept = distance(charts) <= 1.0;
    }

    DevelopableCharts finish(const Draft& draft, Straightening straightening, Progress& progress) {
        auto finishing = progress.part("finishing borders", 1.0);
        if (!options_.straighten_boundaries)
            straightening = Straightening::none;
        else if (!options_.merge_charts) // the bound is F_max then, and not a stretch
            straightening = Straightening::fitting;
        FullCharts full = working_.carry_over(draft, patch_, growing_.max_fitting_error,
                                              straightening, finishing);
        DevelopableCharts result = result_;
        result.chart = std::move(full.chart);
        result.seam = std::move(full.seam);
        result.darts = full.darts;
        result.fitting_error = working_.fitting_errors(result.chart);
        finishing.check();
        return result;
    }

    const DevelopableChartsOptions& options_;
    const bool creased_;
    DChartsOptions growing_;
    WorkingSurface working_;
    std::vector<Index> patch_; // #F of the working surface: charts before joining
    DevelopableCharts result_; // what is known so far
};

} // namespace

OptionRanges<DevelopableChartsOptions> DevelopableChartsOptions::ranges() {
    using O = DevelopableChartsOptions;
    OptionRanges<O> ranges = {{&O::charts_number, {"charts_number", 0, 1e9}},
                              {&O::merge_threshold, {"merge_threshold", 0.0, 1.0, true}},
                              {&O::max_l2_stretch, {"max_l2_stretch", 1.0, 100.0, true}},
                              {&O::max_linf_stretch, {"max_linf_stretch", 0.0, 1000.0}}};
    for (const auto& [field, range] : DChartsOptions::ranges())
        std::visit([&, &r = range](auto f) { ranges.push_back({f, r}); }, field);
    return ranges;
}

DevelopableCharts segment_developable_charts(const Mesh& mesh,
                                             const DevelopableChartsOptions& options,
                                             Progress& progress) {
    if (options.charts_number != 0)
        check_charts_number(mesh.face_count(), options.charts_number);
    check_ranges(options);
    if (options.max_linf_stretch != 0.0 && options.max_linf_stretch <= 1.0)
        refuse_option("max_linf_stretch", "0 for no bound, or a number above 1",
                      options.max_linf_stretch);
    auto coarsening = progress.part("coarsening", 0.06);
    Designer designer(mesh, options, coarsening);
    return designer.run(progress);
}

} // namespace devseg::dcharts
