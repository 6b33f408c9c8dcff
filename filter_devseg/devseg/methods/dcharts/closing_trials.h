// Trials of closings, on a coarse surface where that is worth it, and the last word on those that
// would be the best.
#pragma once

#include <optional>
#include <vector>

#include "devseg/methods/dcharts/coarse_trials.h"
#include "devseg/methods/dcharts/joins.h"

namespace devseg::dcharts {

/// What a trial has found. It is tried again, after its charts have changed, only where the older
/// verdict makes it the best that there is, and at the end: the more of a chart is closed, the more
/// another part costs.
struct Verdict {
    judge::TrialMap map;    // of the joined chart
    judge::TrialMap coarse; // the same on the coarse surface, where it was tried there
    double added = 0.0;     // excess
    double saved = 0.0;     // length of seam, internal units
    bool whole = false;     // the whole border of two charts
    bool tried = false;
    bool fresh = false;     // found with the charts as they are now
    bool is_coarse = false; // it was tried on the coarse surface
    bool confirmed = false; // on the surface itself
    bool refused = false;   // by the final map, which other joins do not make better
    double hidden = 0.0;    // excess that the coarse surface did not show
};

class ClosingTrials {
public:
    /// All must outlive it.
    ClosingTrials(const Mesh& mesh, const MergeOptions& options, const Draft& draft)
        : mesh_(mesh), options_(options), draft_(draft) {}

    /// Makes the coarse surface where that is worth it and there is none. Vertices marked in
    /// `fixed` (#V) stay.
    void prepare(const std::vector<std::uint8_t>& fixed, Progress& progress);

    /// Whether parts of borders may end at the vertex.
    bool has(Vertex v) const { return !coarse_ || coarse_->has(v); }

    /// Several threads may call it.
    void attempt(const Closing& closing, Verdict& verdict, const Progress& progress) const;

    /// On the surface itself, with overlaps pushed apart; by the final map where the options ask
    /// for it.
    void confirm(const Closing& closing, Verdict& verdict, Progress& progress) const;

    /// Whether the verdict needs no more confirmation.
    bool is_sure(const Verdict& verdict) const {
        return verdict.confirmed ||
               (!options_.confirm && !verdict.is_coarse && !verdict.map.overlaps);
    }

    /// Whether the joined chart's stretch is within its bounds. Worst spots are other ones on the
    /// coarse surface: only the mean counts there.
    bool holds(const Closing& closing, const Verdict& verdict) const;

    /// Takes a closing over; true where all verdicts are old by that. The draft has it not yet.
    bool close(const Closing& closing, const Verdict& verdict);

    /// Stretch up to which a joined chart may be worth having.
    StretchBounds bounds_of(const Pair& pair) const;

    /// The cuts inside the joined chart (3 #F): those of both, and what is left of the border.
    std::vector<std::uint8_t> seam_without(const Closing& closing) const;

private:
    /// With cuts to a disk of that length in the joined chart.
    double saved_by(const Closing& closing, double cut_length, const judge::TrialMap& a,
                    const judge::TrialMap& b) const;
    judge::TrialMap try_fine(const Closing& closing, const judge::TrialEffort& effort,
                             std::vector<Vec2> turns, const Progress& progress) const;
    void try_coarse(const Closing& closing, const judge::TrialEffort& effort,
                    std::vector<Vec2> turns, const Progress& progress, Verdict& verdict) const;
    void assess(const Closing& closing, judge::TrialMap map, Verdict& verdict) const;
    void assess(const Closing& closing, judge::TrialMap map, const judge::TrialMap& a,
                const judge::TrialMap& b, Verdict& verdict) const;

    const Mesh& mesh_;
    const MergeOptions& options_;
    const Draft& draft_;
    std::optional<CoarseTrials> coarse_;
};

/// Of edges, each given by a half-edge.
double length_of(const Mesh& mesh, const std::vector<Index>& edges);

} // namespace devseg::dcharts
