// How a surface in one piece is segmented: patches grow, are joined and cut by darts on a coarse
// surface, and the result is carried to the full one.
#pragma once

#include <optional>

#include "devseg/judge/roughness.h"
#include "devseg/methods/dcharts/developable_charts.h"
#include "devseg/methods/dcharts/draft.h"
#include "devseg/methods/dcharts/full_charts.h"

namespace devseg::dcharts {

/// How the surface at hand is segmented.
struct SegmentationPlan {
    const DevelopableChartsOptions& options;
    bool creased;
    DChartsOptions growing;
    judge::Roughness rough; // of the surface on which is decided, where it is rough
};

/// Whether this l2² − 1 of small neighbourhoods counts.
bool is_rough(double excess);

SegmentationPlan make_plan(const Mesh& mesh, const DevelopableChartsOptions& options);

/// Stretch that joined charts may have, from η: at η = 0.01, L2 1.005 and L∞ 1.4.
StretchBounds bounds_from(double merge_threshold);

struct Aim {
    StretchBounds chart;
    double max_excess = infinite;
    bool few = false; // few charts matter more than wide necks between their parts
};

/// Of a given number of charts.
Aim aim_of(const SegmentationPlan& plan);

/// What is decided on the decimated surface.
struct Decided {
    DChartsResult patches; // before joining
    Draft draft;
};

/// The patches that charts are joined from.
DChartsResult grow_patches(const Mesh& mesh, const SegmentationPlan& plan, Progress& progress);

/// Joins, and cuts darts: a draft for each of the growing bounds of its excess.
std::vector<Draft> improve(const Mesh& mesh, const SegmentationPlan& plan, Aim aim,
                           const std::vector<double>& max_excess, Draft draft, Progress& progress);

/// For a given number of charts, on the surface on which is decided.
Decided decide(const Mesh& mesh, const SegmentationPlan& plan, DChartsResult patches,
               Progress& progress);

/// The charts of the full surface, with borders in their place.
DevelopableCharts finish(const Mesh& mesh, const std::optional<mesh::CoarseMesh>& decimation,
                         const SegmentationPlan& plan, const Decided& decided,
                         Straightening straightening, Progress& progress);

/// Keeps the bounds of the final map, or only looks whether they are kept. False where a chart had
/// to be cut for that, or would have to be.
bool keep_final_bounds(const Mesh& mesh, const SegmentationPlan& plan, const Aim& aim, bool may_cut,
                       DevelopableCharts& charts, Progress& progress);

} // namespace devseg::dcharts
