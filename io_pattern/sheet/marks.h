// What is drawn into a piece beside its outlines: notches, the grain line, its name and the numbers
// of its seams.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "devseg/assembly/assembly.h"
#include "sheet/sheet_piece.h"

namespace devseg::sheet {

/// A place on an outline.
struct OutlinePlace {
    Vec2 position = Vec2::Zero();
    Vec2 direction = Vec2::UnitX(); // along the outline, the piece on its left
};

/// The place at this distance from the seam's start on one side of it.
OutlinePlace place_on(const pattern::PiecePath& path, const pattern::SeamSide& side,
                      double distance);

/// Adds the notches of the piece, where the pattern has it; the cut and sew lines must be there.
void add_notches(const pattern::Pattern& pattern, const ExportOptions& options, SheetPiece& piece);

/// Adds a cross at the tip of each of the piece's darts.
void add_drills(const pattern::Pattern& pattern, SheetPiece& piece);

/// From where to where an opening is on one side of its seam, mm from the seam's start.
std::pair<double, double> opening_stretch(const pattern::Seam& seam, std::size_t side,
                                          const assembly::Opening& opening);

/// Adds brackets along the stretches of the piece's seams that stay open until the last step.
void add_openings(const pattern::Pattern& pattern, const assembly::Assembly& assembly,
                  SheetPiece& result);

/// Adds the arrow along the threads, where it is long enough to be of use.
void add_grain(const pattern::PatternPiece& piece, SheetPiece& result);

/// Whether the text upside down is another number, as 6 and 16: it is underlined then.
bool is_ambiguous(const std::string& number);

/// What could not be written in a size that can be read.
struct LeftOut {
    std::vector<Index> seams;  // positions in Pattern::seams
    std::vector<Index> pieces; // positions in Pattern::pieces
};

/// Writes names and seam numbers, as the options want them, into pieces that lie in their places.
/// Texts are upright, 2.5 mm high at least, and touch neither lines nor each other; where there is
/// no room for that, they may cross folds and notches. A number stands beside its seam, inside the
/// piece or on the allowance or tab, or at the end of a line that leads to it. Every seam gets its
/// number on both sides or on none, and darts on one.
/// Openings are named as well. `borders`: for each sheet, lines that no text may cross; or nothing.
LeftOut add_texts(const pattern::Pattern& pattern, const assembly::Assembly& assembly,
                  const ExportOptions& options, std::vector<SheetPiece>& pieces,
                  const std::vector<std::vector<std::array<Vec2, 2>>>& borders = {});

} // namespace devseg::sheet
