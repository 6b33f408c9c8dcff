// Pieces on their sheets → DXF for apparel CAD.
#pragma once

#include <string>

#include "sheet/layout.h"

namespace devseg::sheet {

/// What the file says about itself, 7-bit.
struct ApparelHeader {
    std::string style; // name of the garment or toy
    std::string date;  // DD-MM-YYYY
};

/// The file's bytes, 7-bit, after AAMA and ASTM D6673: a block for each piece, its parts on the
/// numbered layers of the standard, millimetres. Which seam joins which piece, for which the
/// standard has no place, is text on layer 15. Layers: 1 boundary and piece texts, 2 turn points,
/// 3 curve points, 4 notches, 7 grain line, 8 folds, 11 cut-outs and slits, 14 sew line, 15 seams.
std::string apparel_dxf_bytes(const pattern::Pattern& pattern, const PatternLayout& layout,
                              const ExportOptions& options, const ApparelHeader& header);

} // namespace devseg::sheet
