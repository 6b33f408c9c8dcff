#include "devseg/methods/dcharts/standing.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "devseg/declare/segmentation_output.h"
#include "devseg/methods/dcharts/tuning.h"

namespace devseg::dcharts {

ChartsAbove charts_above(const atlas::ChartMap& charts, const std::vector<Standing>& standing) {
    std::vector<Standing> worst(at(charts.count), Standing::kept);
    for (std::size_t f = 0; f < standing.size(); ++f)
        worst[charts.chart[f]] = std::max(worst[charts.chart[f]], standing[f]);
    ChartsAbove above;
    for (const Standing s : worst) {
        above.chart.push_back(s != Standing::kept ? 1 : 0);
        above.count += s != Standing::kept ? 1 : 0;
        above.rough += s == Standing::rough ? 1 : 0;
    }
    return above;
}

void tell(const ChartsAbove& above, double roughness, declare::FilterOutput& output) {
    declare::select_charts(above.chart, output);
    if (above.count > above.rough)
        output.notes.push_back(std::to_string(above.count - above.rough) +
                               " charts are above their bound of stretch: no smaller part of them "
                               "could be flattened within it; their faces are selected");
    if (above.rough > 0)
        output.notes.push_back(std::to_string(above.rough) +
                               " charts are above their bound of stretch by no more than the "
                               "roughness of the surface; their faces are selected");
    if (above.rough > 0 || roughness > tuning.rough)
        output.notes.push_back("the surface is rough: its smallest parts have an L2 stretch of " +
                               std::to_string(std::sqrt(1.0 + roughness)) +
                               " in the mean, which counts apart; smooth or simplify it first");
}

} // namespace devseg::dcharts
