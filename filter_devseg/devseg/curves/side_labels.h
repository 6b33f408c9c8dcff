// Charts of a finer mesh, from the curves between them.
#pragma once

#include <utility>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/mesh/refinement.h"

namespace devseg::curves {

/// A piece of a curve, between two vertices of the finer mesh. Each comes in both directions.
struct Piece {
    Index from;
    Index to;
    Index curve;
    Index label; // of the chart on its left
    bool operator<(const Piece& other) const {
        return std::pair(from, to) < std::pair(other.from, other.to);
    }
};

/// The charts that an edge of a curve's path had on its sides. A curve that has shrunk to a point
/// has no pieces left.
struct Sides {
    Index left;
    Index right;
    Index curve;
};

/// Labels spread from the two sides of the pieces (sorted) over the finer mesh; components without
/// seams keep theirs: old face f is face f or a part of it. Curves whose pieces are no edges, or
/// whose charts (`sides`: of all paths) would fall apart, be gone or run into each other, are added
/// to `failed`.
atlas::ChartMap label_sides(const mesh::Refinement& refinement, const atlas::ChartMap& old,
                            const std::vector<Piece>& pieces, const std::vector<Sides>& sides,
                            std::vector<Index>& failed);

} // namespace devseg::curves
