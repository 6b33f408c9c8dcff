#include "devseg/pack/sheet.h"

#include <algorithm>

namespace devseg {

namespace {

bool bit(const std::uint64_t* row, Index x) {
    return ((row[x / 64] >> (x % 64)) & 1) != 0;
}

// target &= ~(source >> shift), where the row is one number of `words` words.
void clear_shifted(std::uint64_t* target, const std::uint64_t* source, Index words, Index shift) {
    const Index skip = shift / 64;
    const int low = shift % 64;
    for (Index w = 0; w + skip < words; ++w) {
        std::uint64_t value = source[w + skip] >> low;
        if (low != 0 && w + skip + 1 < words)
            value |= source[w + skip + 1] << (64 - low);
        target[w] &= ~value;
    }
}

Index floor_log2(Index x) {
    Index result = 0;
    while (x >> (result + 1) > 0)
        ++result;
    return result;
}

} // namespace

ChartCells::ChartCells(const BitImage& image) : width(image.width), height(image.height) {
    for (Index y = 0; y < height; ++y)
        for (Index x = 0; x < width;) {
            if (!bit(image.row(y), x)) {
                ++x;
                continue;
            }
            Index end = x;
            while (end < width && bit(image.row(y), end))
                ++end;
            runs.push_back({y, x, end - x});
            x = end;
        }
    // Long runs hit something most often; neighbours of a run that was tried add little, so rows
    // far from one another come first.
    std::stable_sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) {
        const Index coarse_a = a.row % 8 == 0 ? 0 : a.row % 2 == 0 ? 1 : 2;
        const Index coarse_b = b.row % 8 == 0 ? 0 : b.row % 2 == 0 ? 1 : 2;
        return coarse_a != coarse_b ? coarse_a < coarse_b : a.length > b.length;
    });
}

Sheet::Sheet(Index width, Index height)
    : width_(width), height_(height), words_((width + 63) / 64), levels_(floor_log2(width) + 1),
      cells_(at(words_) * at(levels_) * at(height), 0) {}

std::optional<Spot> Sheet::find_lowest(const ChartCells& chart, Index top_limit) const {
    const Index places = width_ - chart.width + 1;
    if (places <= 0)
        return std::nullopt;
    const Index place_words = (places + 63) / 64;
    std::vector<std::uint64_t> all(at(words_), 0);
    for (Index w = 0; w < place_words; ++w)
        all[at(w)] = ~std::uint64_t{0};
    if (places % 64 != 0)
        all[at(place_words - 1)] >>= 64 - places % 64;
    std::vector<std::uint64_t> free(at(words_));
    const Index last = std::min(top_limit, height_) - chart.height;
    for (Index y = 0; y <= last; ++y) {
        free = all;
        bool any = true;
        for (std::size_t i = 0; i < chart.runs.size() && any; ++i) {
            const ChartCells::Run& run = chart.runs[i];
            if (y + run.row >= used_rows_)
                continue;
            // Two blocks of 2^j cells cover the run.
            const Index level = floor_log2(run.length);
            const std::uint64_t* taken = row(level, y + run.row);
            clear_shifted(free.data(), taken, words_, run.first);
            const Index rest = run.length - (Index{1} << level);
            if (rest > 0)
                clear_shifted(free.data(), taken, words_, run.first + rest);
            if (i % 4 == 3)
                any = std::any_of(free.begin(), free.begin() + place_words,
                                  [](std::uint64_t w) { return w != 0; });
        }
        for (Index w = 0; w < place_words && any; ++w)
            for (Index b = 0; b < 64 && free[at(w)] != 0; ++b)
                if (((free[at(w)] >> b) & 1) != 0)
                    return Spot{64 * w + b, y};
    }
    return std::nullopt;
}

void Sheet::occupy(const ChartCells& chart, const Spot& spot) {
    for (const ChartCells::Run& run : chart.runs) {
        std::uint64_t* cells = row(0, spot.y + run.row);
        for (Index x = spot.x + run.first; x < spot.x + run.first + run.length; ++x)
            cells[x / 64] |= std::uint64_t{1} << (x % 64);
    }
    for (Index y = spot.y; y < spot.y + chart.height; ++y)
        refresh(y);
    used_rows_ = std::max(used_rows_, spot.y + chart.height);
}

void Sheet::refresh(Index y) {
    for (Index level = 1; level < levels_; ++level) {
        const std::uint64_t* half = row(level - 1, y);
        std::uint64_t* whole = row(level, y);
        const Index shift = Index{1} << (level - 1);
        const Index skip = shift / 64;
        const int low = shift % 64;
        for (Index w = 0; w < words_; ++w) {
            std::uint64_t moved = w + skip < words_ ? half[w + skip] >> low : 0;
            if (low != 0 && w + skip + 1 < words_)
                moved |= half[w + skip + 1] << (64 - low);
            whole[w] = half[w] | moved;
        }
    }
}

} // namespace devseg
