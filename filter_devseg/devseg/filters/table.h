// The table of all filters.
#pragma once

#include <vector>

#include "devseg/declare/filter.h"

namespace devseg::filters {

/// All filters of the suite, in the order of the menus.
const std::vector<declare::FilterDeclaration>& filter_table();

} // namespace devseg::filters
