// Which pages of a sheet are printed.
//
// Pages that are glued share strips, so that parts of a sheet are shown by one page, by two, or
// where strips cross by four. Along each axis the parts of one page (even numbers) and the strips
// (odd numbers) take turns.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "devseg/base/numbers.h"

namespace devseg::sheet {

/// Of so many pages along an axis.
inline Index parts_of(Index pages) {
    return std::max(Index{0}, 2 * pages - 1);
}

/// The first and the last page that show a part, along an axis.
inline std::array<Index, 2> pages_of_part(Index part) {
    return {part / 2, (part + 1) / 2};
}

/// The page that each part is printed on, in rows from below and in columns from the left; −1: that
/// of parts where nothing is. As few pages as a greedy choice finds: those that alone show
/// something, and then those that show the most of what is left. `amounts`: of what lies on each
/// part, row by row.
std::vector<Index> cover_parts(Index columns, Index rows, const std::vector<Index>& amounts);

} // namespace devseg::sheet
