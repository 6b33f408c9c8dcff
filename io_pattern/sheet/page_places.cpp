#include "sheet/page_places.h"

#include <algorithm>
#include <bitset>

namespace devseg::sheet {

namespace {

using Word = Bits::value_type;

void set_range(Word* words, Index first, Index end) {
    for (Index x = first; x < end;) {
        const Index word = x / bits_in_word;
        const Index stop = std::min(end, (word + 1) * bits_in_word);
        words[word] |= (~Word{0} >> (bits_in_word - (stop - x))) << (x % bits_in_word);
        x = stop;
    }
}

Index ones(Word word) {
    return static_cast<Index>(std::bitset<bits_in_word>(word).count());
}

} // namespace

void set_bits(Bits& bits, Index first, Index end) {
    set_range(bits.data(), first, end);
}

bool any_bit(const Bits& bits) {
    return std::any_of(bits.begin(), bits.end(), [](Word word) { return word != 0; });
}

Index count_bits(const Bits& bits) {
    Index count = 0;
    for (const Word word : bits)
        count += ones(word);
    return count;
}

Index nth_bit(const Bits& bits, Index n) {
    Index x = 0;
    for (const Word word : bits) {
        if (n < ones(word)) {
            for (Word rest = word;; rest >>= 1, ++x)
                if ((rest & 1) != 0 && n-- == 0)
                    return x;
        }
        n -= ones(word);
        x += bits_in_word;
    }
    return -1;
}

void PlaceCounts::add(const Bits& places) {
    for (std::size_t k = 0; k < places.size(); ++k) {
        Word carry = places[k];
        for (std::size_t d = 0; carry != 0; ++d) {
            if (d == used_) {
                if (++used_ > digits_.size())
                    digits_.emplace_back(words_);
                std::fill(digits_[d].begin(), digits_[d].end(), Word{0});
            }
            const Word both = digits_[d][k] & carry;
            digits_[d][k] ^= carry;
            carry = both;
        }
    }
}

Index PlaceCounts::keep_least(Bits& candidates) const {
    Index least = 0;
    for (std::size_t d = used_; d-- > 0;) {
        Word lower = 0;
        for (std::size_t k = 0; k < candidates.size(); ++k)
            lower |= candidates[k] & ~digits_[d][k];
        if (lower == 0)
            least += Index{1} << d;
        else
            for (std::size_t k = 0; k < candidates.size(); ++k)
                candidates[k] &= ~digits_[d][k];
    }
    return least;
}

Reach::Reach(const pack::ChartCells& image, Index width, Index height)
    : first_row_(1 - height), rows_(image.height + height - 1), origin_(1 - image.width),
      words_(words_for(image.width + width - 1)), bits_(at(rows_) * words_, 0) {
    // Of the image's own rows.
    Bits own(at(image.height) * words_, 0);
    for (const pack::CellRun& run : image.runs)
        set_range(own.data() + at(run.row) * words_, 1 - run.last - origin_,
                  width - run.first - origin_);
    for (Index row = 0; row < rows_; ++row)
        for (Index y = std::max(Index{0}, row + first_row_);
             y < std::min(row + first_row_ + height, image.height); ++y)
            for (std::size_t k = 0; k < words_; ++k)
                bits_[at(row) * words_ + k] |= own[at(y) * words_ + k];
}

bool Reach::add_places(Index left, Index bottom, Index y, Bits& places) const {
    const Index row = bottom - y - first_row_;
    if (row < 0 || row >= rows_)
        return false;
    const Word* from = bits_.data() + at(row) * words_;
    const Index shift = left + origin_;
    const auto count = static_cast<Index>(places.size());
    // Whole words, downwards also for places left of the board, which do not count.
    const Index whole =
        shift >= 0 ? shift / bits_in_word : -((bits_in_word - 1 - shift) / bits_in_word);
    const Index part = shift - whole * bits_in_word;
    for (std::size_t i = 0; i < words_; ++i) {
        const Index k = static_cast<Index>(i) + whole;
        if (k >= 0 && k < count)
            places[at(k)] |= from[i] << part;
        if (part > 0 && k + 1 >= 0 && k + 1 < count)
            places[at(k + 1)] |= from[i] >> (bits_in_word - part);
    }
    return true;
}

} // namespace devseg::sheet
