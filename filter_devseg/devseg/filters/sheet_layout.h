// Flat charts → texture coordinates on one sheet, as hosts store them.
#pragma once

#include <vector>

#include "devseg/declare/filter.h"
#include "devseg/flatten/flatten.h"
#include "devseg/pack/pack.h"

namespace devseg::filters {

struct SheetLayout {
    CornerUv uv;
    Index unsettled = 0;            // faces that rounding flattened
    int thin = 0;                   // charts that rounding stretches
    std::vector<std::uint8_t> look; // #F: 1 in those
};

/// Moves flat charts to their places, rounds them to 32 bit, and spreads them to corners. The sheet
/// has the side `scale_to_side`, or for 0 the size of the model, in model units.
SheetLayout lay_out(const Mesh& mesh, std::vector<flatten::FlatChart>& charts,
                    const pack::PackOptions& options, double scale_to_side, Progress& progress);

/// The same in rows, in model units and without any search for room.
SheetLayout lay_out_in_rows(const Mesh& mesh, std::vector<flatten::FlatChart>& charts);

/// Tells the user about faces that rounding flattened and charts that it stretches, and selects the
/// faces of these.
void note_unsettled(const SheetLayout& layout, declare::FilterOutput& output);

} // namespace devseg::filters
