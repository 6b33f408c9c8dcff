// What a pattern takes to make, and its steps in words.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "sheet/layout.h"

namespace devseg::sheet {

/// Material is cloth, paper or board: the area inside all cut lines, allowances and tabs included.
struct Needs {
    double material_mm2 = 0.0;
    std::vector<double> fabric_mm2; // of each of the pattern's fabrics
    double seam_mm = 0.0;           // of all seams, mean of both sides
    double hem_mm = 0.0;            // of what is sewn to nothing
    double minutes = 0.0;           // to sew seams and hems, pinning included
    double stuffing_mm3 = 0.0;      // volume of the closed solids; 0 where nothing is sewn shut
    double stuffing_g = 0.0;
    Index sheets_of_paper = 0; // pages; 0 where no page size is given
};

Needs find_needs(const pattern::Pattern& pattern, const PatternLayout& layout,
                 const ExportOptions& options, Index pages);

/// For people, name and value each.
std::vector<std::pair<std::string, std::string>>
needs_texts(const pattern::Pattern& pattern, const Needs& needs, const ExportOptions& options);

/// "Section B: sew P04 to what is made, along 3, 7." Step k of the layout's assembly.
std::string step_text(const pattern::Pattern& pattern, const PatternLayout& layout,
                      const ExportOptions& options, std::size_t k);

/// "Leave 60 mm of seam 5 open, from 20 mm after its start." One for each opening.
std::vector<std::string> opening_texts(const pattern::Pattern& pattern,
                                       const PatternLayout& layout);

} // namespace devseg::sheet
