// How the material is strained, in words: for the cover and the page.
#pragma once

#include <string>
#include <vector>

#include "devseg/pattern/pattern.h"

namespace devseg::sheet {

/// "along the grain 3.1 % (95 %: 2.0 %), across it 4 % (…), 80 % of what fleece bears"; of a piece
/// of a pattern with a material.
std::string cloth_text(const pattern::Pattern& pattern, const pattern::PatternPiece& piece);

/// A line for each piece, and one for each seam whose sides differ so much that one is gathered.
/// Empty without a material.
std::vector<std::string> cloth_texts(const pattern::Pattern& pattern);

} // namespace devseg::sheet
