// A segmentation while it is being improved: every chart with its trial map.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/judge/trial.h"
#include "devseg/mesh/mesh.h"

namespace devseg::dcharts {

struct Draft {
    std::vector<Index> chart;       // #F
    std::vector<std::uint8_t> seam; // 3 #F, symmetric: cuts inside charts
    std::vector<Index> tips;        // vertices where darts end, in the order of cutting
    std::vector<std::vector<Index>>
        faces;                        // of each chart, ascending; empty for charts that are gone
    std::vector<judge::TrialMap> map; // of each chart

    Index charts_number() const;
    double excess() const; // Σ A (l2² − 1) over the charts, internal units squared
    double linf() const;   // over the charts
};

/// Labels of edge-connected charts and cuts inside them (3 #F, empty for none) → a draft, all
/// charts tried; the stretch is to be compared with `wanted_l2`.
Draft make_draft(const Mesh& mesh, const std::vector<Index>& chart,
                 const std::vector<std::uint8_t>& seam, double wanted_l2, Progress& progress);

/// The same without trials, for a segmentation that stays as it is.
Draft make_untried_draft(const Mesh& mesh, const std::vector<Index>& chart);

/// Stretch that a chart should not exceed.
struct StretchBounds {
    double l2 = 1.005;
    double linf = 1.5;

    bool hold(const judge::TrialMap& map) const {
        return map.l2_squared <= l2 * l2 && map.linf <= linf;
    }
};

} // namespace devseg::dcharts
