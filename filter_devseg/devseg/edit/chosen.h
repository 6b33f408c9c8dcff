// What the user means: what is selected, or what numbers on the pattern name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "devseg/declare/filter.h"

namespace devseg::edit {

/// Numbers as users write them: "3,5", "P03 P05". Throws InvalidParameter, naming the parameter.
std::vector<int> read_numbers(const std::string& parameter, const std::string& text);

/// The charts with a selected face; without selected faces, those around selected vertices. Where
/// `pieces` is not empty: those of the pieces that it names, as they are numbered on the pattern of
/// the mesh's texture coordinates. Ascending. Throws InvalidMesh where nothing is selected.
std::vector<Index> chosen_charts(const declare::FilterInput& input, const atlas::ChartMap& charts,
                                 const std::string& pieces, Progress& progress);

/// Marks (3 #F) of the seams between two selected faces; without selected faces, of the selected
/// edges. Where `seams` is not empty: those with its numbers on the pattern. `whole`: with all of
/// the seam from one junction to the next. Throws InvalidMesh where that is none.
std::vector<std::uint8_t> chosen_seams(const declare::FilterInput& input,
                                       const atlas::ChartMap& charts, const std::string& seams,
                                       bool whole, Progress& progress);

/// The selected vertices; where `vertices` is not empty, the host's vertices with its numbers.
std::vector<Index> chosen_vertices(const declare::FilterInput& input, const std::string& vertices);

} // namespace devseg::edit
