// Packing flat charts into the unit square, by outline and at one common scale.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"
#include "devseg/plane/plane.h"

namespace devseg::pack {

/// How much is done to make a layout dense.
enum class PackEffort {
    fast,   // charts are fitted in one after the other, and that is all: milliseconds
    normal, // the search ends where it would have to go on twice as long for 0.5 % more
    best    // it goes on
};

struct PackOptions {
    double padding = 0.002;     // least distance of two charts, as a share of the square's side
    bool allow_rotation = true; // turn each chart, by any angle
    PackEffort effort = PackEffort::normal;
};

/// A chart to pack, in any units that all charts share.
struct PackItem {
    const std::vector<Triangle>* faces = nullptr; // #f
    const std::vector<Vec2>* points = nullptr;    // #v
};

/// The rigid motion of one chart: rotation first, then translation. Never a mirror image.
struct Placement {
    double cosine = 1.0;
    double sine = 0.0;
    Vec2 offset = Vec2::Zero();

    Vec2 operator()(const Vec2& p) const { return plane::turned(p, cosine, sine) + offset; }
};

struct PackResult {
    std::vector<Placement> placements; // one for each item, in the items' units
    double side = 0.0;                 // of the square [0, side]² that holds all of them
};

/// A square is shrunk again and again, and the overlaps that appear are separated by guided local
/// search on a coarse and then on a fine grid (see nest.h); at last the outlines themselves are
/// pushed together (see compaction.h). Small is the box of the layout, almost whatever its shape:
/// up to 4 charts, which cannot fill a square, are tried in flatter and flatter rectangles. Placed
/// charts are at least `padding` · side apart. More than 40 charts are fitted in one after the
/// other first (see first_fit.h), and searched for where that leaves much room; more than 1000 are
/// only fitted in, as all are with the least effort. One chart takes its best box. The same bytes
/// whatever the number of threads. Throws InvalidParameter for a padding outside of [0, 0.1], or
/// one that leaves no room for so many charts, and Cancelled.
PackResult pack_charts(const std::vector<PackItem>& items, const PackOptions& options,
                       Progress& progress);

/// The charts as they stand, side by side in rows of falling height, in a box that is about square:
/// at once, for layouts whose room costs nothing. Rows and charts are `padding` times the longest
/// side of a chart apart.
PackResult pack_rows(const std::vector<PackItem>& items, double padding);

} // namespace devseg::pack
