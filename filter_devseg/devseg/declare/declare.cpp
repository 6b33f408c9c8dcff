#include "devseg/declare/declare.h"

#include <locale>
#include <sstream>

namespace devseg::declare {

double checked(const std::string& name, double minimum, double maximum, double value) {
    if (value >= minimum && value <= maximum)
        return value;
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << name << ": expected a number from " << minimum << " to " << maximum << ", found "
         << value;
    throw InvalidParameter(text.str());
}

atlas::ChartMap find_charts(const FilterInput& input) {
    if (input.charts)
        return *input.charts;
    if (input.uv)
        return atlas::charts_from_uv(input.mesh, *input.uv);
    return atlas::make_chart_map(input.mesh, std::vector<Index>(input.mesh.faces.size(), 0), {},
                                 false);
}

} // namespace devseg::declare
