// Charts above their bounds are named: in results, by a note each, and by a selection.
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/declare/filter.h"
#include "devseg/methods/dcharts/developable_charts.h"

namespace devseg::dcharts {

struct ChartsAbove {
    std::vector<std::uint8_t> chart; // #charts: 1 for those above a bound of their own
    int count = 0;
    int rough = 0; // of these, by no more than the roughness of the surface

    bool any() const { return count > 0; }
};

/// `standing`: #F. A chart that was cut on stands as the worst of its faces.
ChartsAbove charts_above(const atlas::ChartMap& charts, const std::vector<Standing>& standing);

/// Notes on them, their faces selected, and a note where the surface is rough (`roughness`: l2² − 1
/// of small neighbourhoods). The output has its charts.
void tell(const ChartsAbove& above, double roughness, declare::FilterOutput& output);

} // namespace devseg::dcharts
