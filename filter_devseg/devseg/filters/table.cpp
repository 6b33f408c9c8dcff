#include <iterator>
#include <locale>
#include <sstream>

#include "devseg/declare/declare.h"
#include "devseg/filters/filter_groups.h"

namespace devseg::filters {

const std::vector<declare::FilterDeclaration>& filter_table() {
    static const std::vector<declare::FilterDeclaration> table = [] {
        std::vector<declare::FilterDeclaration> all;
        for (auto group :
             {segmentation_filters(), t_flooding_filters(), plush_filters(), papercraft_filters(),
              baseline_filters(), deformation_filters(), flattening_filters(), pattern_filters(),
              sewn_preview_filters(), measure_filters(), circle_map_filters()})
            std::move(group.begin(), group.end(), std::back_inserter(all));
        return all;
    }();
    return table;
}

double checked(const std::string& name, double minimum, double maximum, double value) {
    if (value >= minimum && value <= maximum)
        return value;
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << name << ": expected a number from " << minimum << " to " << maximum << ", found "
         << value;
    throw InvalidParameter(text.str());
}

atlas::ChartMap find_charts(const declare::FilterInput& input) {
    if (input.charts)
        return *input.charts;
    if (input.uv)
        return atlas::charts_from_uv(input.mesh, *input.uv);
    return atlas::make_chart_map(input.mesh, std::vector<Index>(input.mesh.faces.size(), 0), {},
                                 false);
}

} // namespace devseg::filters
