// All places of a piece on a board at the same time: rows of bits.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/pack/separation.h"

namespace devseg::sheet {

/// A row of places, from column 0 on.
using Bits = std::vector<std::uint64_t>;

constexpr Index bits_in_word = 64;
inline std::size_t words_for(Index bits) {
    return at((bits + bits_in_word - 1) / bits_in_word);
}
/// Sets those of columns first … end − 1.
void set_bits(Bits& bits, Index first, Index end);
bool any_bit(const Bits& bits);
Index count_bits(const Bits& bits);
/// The column of the n-th that is set, from 0 on.
Index nth_bit(const Bits& bits, Index n);

/// How often each place of a row was counted: one row of bits for each binary digit.
class PlaceCounts {
public:
    explicit PlaceCounts(std::size_t words) : words_(words) {}

    void clear() { used_ = 0; }
    void add(const Bits& places);
    /// Only those candidates stay that were counted least; returns how often. One is needed.
    Index keep_least(Bits& candidates) const;

private:
    std::size_t words_;
    std::size_t used_ = 0; // digits
    std::vector<Bits> digits_;
};

/// Whether an image reaches into a rectangle, wherever both lie.
class Reach {
public:
    /// `width` and `height` of the rectangle, cells.
    Reach(const pack::ChartCells& image, Index width, Index height);

    /// Adds the places in row y from which the image reaches into the rectangle with this corner.
    /// False where it is too far below or above.
    bool add_places(Index left, Index bottom, Index y, Bits& places) const;

private:
    Index first_row_ = 0; // of the rectangle, below the image's own
    Index rows_ = 0;
    Index origin_ = 0; // bit 0 stands for a place so far to the left of the rectangle
    std::size_t words_ = 0;
    Bits bits_; // row by row
};

} // namespace devseg::sheet
