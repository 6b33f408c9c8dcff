// Flat charts → texture coordinates on one sheet, as hosts store them.
#pragma once

#include <string>
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

/// What users choose among for a pack::PackEffort, and what they read about it.
std::vector<std::string> effort_names();
constexpr const char* effort_help =
    "How long to look for a dense layout. Fast: charts are fitted in one after the other, in "
    "milliseconds. Normal: a search, while it pays. Best: it goes on for about twice as long and "
    "covers some 0.5 % more.";

pack::PackOptions packing_with(pack::PackEffort effort);

/// Tells the user about faces that rounding flattened and charts that it stretches, and selects the
/// faces of these.
void note_unsettled(const SheetLayout& layout, declare::FilterOutput& output);

} // namespace devseg::filters
