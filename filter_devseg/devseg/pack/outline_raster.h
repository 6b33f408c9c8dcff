// Charts as bit images: which cells of a grid a placed chart may touch.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg {

/// A bit image; row y has `words` words, bit x of a row is (word[x / 64] >> x % 64) & 1.
struct BitImage {
    Index width = 0;  // cells
    Index height = 0; // cells
    Index words = 0;  // of each row
    std::vector<std::uint64_t> bits;

    BitImage() = default;
    BitImage(Index w, Index h)
        : width(w), height(h), words((w + 63) / 64),
          bits(static_cast<std::size_t>(words) * static_cast<std::size_t>(h), 0) {}
    std::uint64_t* row(Index y) { return bits.data() + static_cast<std::ptrdiff_t>(y) * words; }
    const std::uint64_t* row(Index y) const {
        return bits.data() + static_cast<std::ptrdiff_t>(y) * words;
    }
};

/// All cells that come closer than `margin` to a triangle (and a few more: the image is
/// conservative). Triangles lie in the quarter plane x ≥ margin, y ≥ margin; coordinates are in
/// units of length, `cell` is the width of a cell.
BitImage rasterize(const std::vector<Triangle>& faces, const std::vector<Vec2>& points,
                   double cell, double margin);

} // namespace devseg
