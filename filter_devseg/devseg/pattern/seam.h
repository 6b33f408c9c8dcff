// A seam: two sides of pieces that are sewn, glued or taped together.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::pattern {

/// What lies along one edge of an outline: a side of a seam, or the open boundary of the model.
struct OutlineSeam {
    Index seam = -1; // position in Pattern::seams; −1 = boundary of the model, sewn to nothing
    int side = 0;    // which of the seam's two sides
    bool is_dart = false;
};

/// One side of a seam: the edges first, first + 1, … (modulo their number) of one outline. Side 0
/// runs along its outline; side 1 runs against its own, so that both start at the same end.
struct SeamSide {
    Index piece = -1;            // position in Pattern::pieces
    Index path = 0;              // PatternPiece::path
    Index first = 0;             // first edge in the direction of the outline
    Index count = 0;             // edges
    bool reversed = false;       // the seam runs against the outline, from the last edge's end
    double length = 0.0;         // mm
    std::vector<double> notches; // mm from the seam's start on this side, ascending
};

/// Two sides that are sewn together, from end to end. A dart joins a piece to itself at a tip.
struct Seam {
    Index number = 0;  // 1, 2, …
    std::string label; // what both sides are marked with, unique in the pattern
    std::array<SeamSide, 2> sides;
    double surface_length = 0.0; // mm at the pattern's scale, on the model
    bool is_dart = false;        // both sides meet at a tip inside the piece: the seam ends there
    bool is_closed = false;      // it has no ends: its start is any point of a loop

    double mismatch() const { return sides[0].length - sides[1].length; } // mm
    double mismatch_percent() const {
        const double mean = 0.5 * (sides[0].length + sides[1].length);
        return mean > 0.0 ? 100.0 * mismatch() / mean : 0.0;
    }
};

} // namespace devseg::pattern
