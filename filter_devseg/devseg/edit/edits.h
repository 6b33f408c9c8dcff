// Changing charts one at a time: joining, splitting, removing seams, cutting darts. Every change is
// judged by the maps that 'Charts: Flatten' would make, and refused where these are no good. Large
// charts that are joined or split are judged on coarse versions of them (see judging.h).
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/option_checks.h"
#include "devseg/base/progress.h"

namespace devseg::edit {

struct EditBounds {
    double max_chart_l2_stretch = 1.02; // of what has changed; 0: no bound
    bool force = false;                 // change it even so

    static OptionRanges<EditBounds> ranges() {
        return {{&EditBounds::max_chart_l2_stretch, {"max_chart_l2_stretch", 0.0, 100.0}}};
    }
};

struct Edit {
    atlas::ChartMap charts;
    Index changed = 0;       // new or larger charts
    double l2_before = 1.0;  // stretch of the worst chart among those that are changed
    double l2_stretch = 1.0; // of the worst one afterwards
    double linf_stretch = 1.0;
    double cut_length = 0.0; // of cuts that made disks of them, internal units
};

/// All errors of these are InvalidParameter, with the reason and the stretch that it would cost;
/// they leave charts that are no disks cut open to disks.

/// Takes seams away (`marks`, 3 #F, symmetric): what they kept apart is joined, and darts are
/// closed.
Edit remove_seams(const Mesh& mesh, const atlas::ChartMap& charts,
                  const std::vector<std::uint8_t>& marks, const EditBounds& bounds,
                  Progress& progress);

/// Joins charts (two or more) that share borders to one.
Edit join_charts(const Mesh& mesh, const atlas::ChartMap& charts, const std::vector<Index>& which,
                 const EditBounds& bounds, Progress& progress);

/// Splits each of the charts along these cuts (3 #F, symmetric), which are completed (see
/// given_charts.h); or, where they do not divide it, the best way in two: as D-Charts splits what
/// is above its bound. Refused where a part would be a sliver. The stretch of a part that lies on
/// itself is the one before flattening cuts it apart.
Edit split_charts(const Mesh& mesh, const atlas::ChartMap& charts, const std::vector<Index>& which,
                  const std::vector<std::uint8_t>& cuts, const EditBounds& bounds,
                  Progress& progress);

/// Cuts a dart from each of the vertices to the border of its chart or to an earlier dart, by a
/// short path. Refused where that does not lower the stretch.
Edit add_darts(const Mesh& mesh, const atlas::ChartMap& charts, const std::vector<Index>& vertices,
               const EditBounds& bounds, Progress& progress);

} // namespace devseg::edit
