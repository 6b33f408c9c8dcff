// The order in which the pieces of a pattern are put together, in steps that hands can do.
//
// Pieces are grouped into sections, such as limbs (sections.h). Each section is made by itself, and
// then joined to what is built. A closed solid that is sewn keeps an opening, to turn it and stuff
// it, which its last step closes; one that is glued keeps a piece that fingers can reach behind. A
// model may be of several parts that share no seam: each is made by itself, what stays open first.
#pragma once

#include <string>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/pattern/pattern.h"

namespace devseg::assembly {

enum class Craft { sewing, papercraft };

enum class StepKind {
    dart = 1, // darts of one piece
    join,     // a piece is joined to the section that is being made; its first step names two
    tube,     // a piece with itself: cones, tubes and slits
    attach,   // a section is joined to what is built
    close     // the opening of a solid, or its last piece
};

struct AssemblyStep {
    StepKind kind = StepKind::join;
    Index section = 0;         // that is made or attached
    std::vector<Index> seams;  // positions in Pattern::seams, in the order in which they are done
    std::vector<Index> pieces; // positions in Pattern::pieces that come to what is built
};

/// The stretch of a seam that stays open until the last step.
struct Opening {
    Index seam = -1;   // position in Pattern::seams
    double from = 0.0; // mm from the seam's start, on side 0
    double to = 0.0;
    bool is_whole = false; // the whole seam: none is long enough for more
};

struct Assembly {
    std::vector<Index> section; // of each piece, 0, 1, … in the order in which they are made
    Index section_count = 0;
    std::vector<AssemblyStep> steps;
    std::vector<Index> seam_step;  // the step that does each seam, from 1 on; with an opening, the
                                   // step that does what is not left open
    std::vector<Opening> openings; // one for each closed solid that is sewn
};

constexpr double least_opening = 40.0; // mm, for a hand with stuffing
constexpr double most_opening = 80.0;

/// Every seam is done in one step, and every step but the first of each section joins pieces that
/// share a seam with what it is joined to. Each solid is closed once, by its own last step, and
/// where there is a solid, the last step of all closes one. The same pattern gives the same order.
/// Throws Cancelled.
Assembly plan_assembly(const pattern::Pattern& pattern, Craft craft, const Progress& progress);

/// "A", "B", …, "Z", "AA", …
std::string section_name(Index section);

} // namespace devseg::assembly
