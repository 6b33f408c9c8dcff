#include "devseg/pack/free_cells.h"

#include <algorithm>
#include <utility>

namespace devseg::pack {

namespace {

constexpr Index word_bits = 64;

Index log2_floor(Index x) {
    Index k = 0;
    while ((x >> (k + 1)) != 0)
        ++k;
    return k;
}

Index length(const CellRun& run) {
    return run.last - run.first;
}

} // namespace

FitImage::FitImage(ChartCells image) : cells(std::move(image)) {
    std::size_t step = 1;
    while (2 * step < cells.runs.size())
        step *= 2;
    for (std::size_t i = 0; i < cells.runs.size(); i += step)
        runs.push_back(cells.runs[i]);
    for (; step > 1; step /= 2)
        for (std::size_t i = step / 2; i < cells.runs.size(); i += step)
            runs.push_back(cells.runs[i]);
}

FreeCells::FreeCells(Index width, Index longest_run)
    : width_(width), words_(at(width / word_bits) + 2), levels_(log2_floor(longest_run) + 1),
      blocked_(words_) {}

bool FreeCells::put(const std::vector<FitImage>& poses, Index from, Index limit, Spot& spot) {
    bool found = false;
    for (std::size_t pose = 0; pose < poses.size(); ++pose)
        if (find(poses[pose], from, limit, spot)) {
            found = true;
            spot.pose = pose;
            limit = spot.y + poses[pose].cells.height;
        }
    if (found)
        take(poses[spot.pose], spot);
    return found;
}

bool FreeCells::find(const FitImage& image, Index from, Index limit, Spot& spot) {
    if (image.cells.width > width_)
        return false;
    for (Index y = from; y + image.cells.height < limit; ++y)
        if (find_blocked(image, y)) {
            spot.x = first_free();
            spot.y = y;
            return true;
        }
    return false;
}

void FreeCells::take(const FitImage& image, const Spot& spot) {
    const Index top = spot.y + image.cells.height;
    if (static_cast<Index>(room_.size()) < top) {
        bits_.resize(at(top) * at(levels_) * words_, 0);
        room_.resize(at(top), width_);
    }
    for (const CellRun& run : image.cells.runs) {
        Word* row = level(spot.y + run.row, 0);
        for (Index x = spot.x + run.first; x < spot.x + run.last; ++x)
            row[x / word_bits] |= Word{1} << (x % word_bits);
    }
    for (Index y = spot.y; y < top; ++y)
        bring_up_to_date(y);
    height_ = std::max(height_, top);
}

// Ored into `to`: the bits from `shift` on, as many words as `count`.
void FreeCells::add_shifted(const Word* from, Index shift, std::size_t count, Word* to) {
    from += shift / word_bits;
    const Index part = shift % word_bits;
    if (part == 0) {
        for (std::size_t i = 0; i < count; ++i)
            to[i] |= from[i];
        return;
    }
    for (std::size_t i = 0; i < count; ++i)
        to[i] |= from[i] >> part | from[i + 1] << (word_bits - part);
}

void FreeCells::bring_up_to_date(Index y) {
    for (Index k = 1; k < levels_; ++k) {
        const Word* finer = level(y, k - 1);
        std::copy(finer, finer + words_, level(y, k));
        const Index shift = Index{1} << (k - 1);
        add_shifted(finer, shift, words_ - 1 - at(shift / word_bits), level(y, k));
    }
    const Word* row = level(y, 0);
    Index longest = 0;
    Index free = 0;
    for (Index x = 0; x < width_; ++x) {
        free = (row[x / word_bits] >> (x % word_bits) & 1) != 0 ? 0 : free + 1;
        longest = std::max(longest, free);
    }
    room_[y] = longest;
}

// Marks the places in row y where the image lies on others; false if none is left.
bool FreeCells::find_blocked(const FitImage& image, Index y) {
    const auto rows = static_cast<Index>(room_.size());
    for (const CellRun& run : image.runs)
        if (y + run.row < rows && length(run) > room_[y + run.row])
            return false;
    last_ = width_ - image.cells.width;
    const std::size_t count = at(last_ / word_bits) + 1;
    std::fill_n(blocked_.begin(), count, Word{0});
    blocked_[count - 1] = ~Word{0} << (last_ % word_bits) << 1; // no places there
    for (const CellRun& run : image.runs) {
        const Index row = y + run.row;
        if (row >= rows)
            continue;
        const Index k = log2_floor(length(run));
        const Index rest = length(run) - (Index{1} << k);
        add_shifted(level(row, k), run.first, count, blocked_.data());
        if (rest > 0)
            add_shifted(level(row, k), run.first + rest, count, blocked_.data());
        if (std::all_of(blocked_.begin(), blocked_.begin() + static_cast<std::ptrdiff_t>(count),
                        [](Word word) { return word == ~Word{0}; }))
            return false;
    }
    return true;
}

Index FreeCells::first_free() const {
    for (Index x = 0; x <= last_; x += word_bits) {
        Word open = ~blocked_[x / word_bits];
        for (Index i = x; open != 0 && i <= last_; ++i, open >>= 1)
            if ((open & 1) != 0)
                return i;
    }
    return -1;
}

} // namespace devseg::pack
