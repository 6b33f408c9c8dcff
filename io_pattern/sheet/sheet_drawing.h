// Pieces on their sheets → drawing, with one layer for each operation, and its pages in a document.
#pragma once

#include <string>

#include "sheet/layout.h"
#include "writers/drawing.h"

namespace devseg::sheet {

/// Layers: "cut" (one path for each piece, holes before the outline; slits are paths of their own,
/// before it),
/// "mountain", "valley", "sew", "notch", "grain", "numbers" and "text" as the options want them;
/// "scale" with the frames of the sheets and check squares of 50 mm and 2 inches. A laser gets
/// "cut", "engrave" and "scale". Sheets lie side by side.
writers::Drawing draw_sheets(const PatternLayout& layout, const ExportOptions& options);

/// A page that shows a part of the drawing at true scale.
struct PrintedPage {
    writers::PageWindow window;
    Index sheet = 0;
    Index row = 0; // from the top
    Index column = 0;
    std::vector<Index> pieces; // positions in the layout that are cut on it
};

/// The pages that hold anything to cut; one with the whole drawing where no page size is given.
std::vector<PrintedPage> printed_pages(const PatternLayout& layout,
                                       const writers::Drawing& drawing);

/// All pages at true scale: each with the border of its part (the trim line), crosses that come to
/// lie on each other on neighbouring pages, a 50 mm bar and a caption.
std::vector<writers::DocumentPage> page_sheets(const PatternLayout& layout,
                                               const writers::Drawing& drawing,
                                               const std::vector<PrintedPage>& pages,
                                               const std::string& title);

/// How the pages lie on the sheets, with check squares at true scale: on the last page of a cover
/// where more than half of it is free, or on one of its own.
void add_overview(const PatternLayout& layout, const writers::Drawing& drawing,
                  const std::vector<PrintedPage>& pages, const std::string& title,
                  std::vector<writers::DocumentPage>& document);

} // namespace devseg::sheet
