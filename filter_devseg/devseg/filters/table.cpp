#include "devseg/filters/table.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace devseg {

using Filters = std::vector<declare::FilterDeclaration>;

// Each method declares its filters in its own folder.
namespace dcharts {
Filters filters();
Filters refinement_filters();
} // namespace dcharts
namespace t_flooding {
Filters filters();
}
namespace plush {
Filters filters();
}
namespace papercraft {
Filters filters();
}
namespace baselines {
Filters filters();
}
namespace edit {
Filters given_filters();
Filters edit_filters();
} // namespace edit

namespace filters {

// Each stage declares its filters in a source of this folder.
Filters chart_filters();
Filters smooth_filters();
Filters deformation_filters();
Filters flattening_filters();
Filters pattern_filters();
Filters sewn_preview_filters();
Filters measure_filters();
Filters texture_filters();

const Filters& filter_table() {
    static const Filters table = [] {
        Filters all;
        for (Filters group :
             {dcharts::filters(), edit::given_filters(), edit::edit_filters(),
              dcharts::refinement_filters(), chart_filters(), smooth_filters(),
              t_flooding::filters(), plush::filters(), papercraft::filters(), baselines::filters(),
              deformation_filters(), flattening_filters(), pattern_filters(),
              sewn_preview_filters(), measure_filters(), texture_filters()})
            std::move(group.begin(), group.end(), std::back_inserter(all));
        return all;
    }();
    return table;
}

} // namespace filters
} // namespace devseg
