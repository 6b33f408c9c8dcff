#include "devseg/pack/first_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "devseg/base/parallel.h"
#include "devseg/pack/compaction.h"
#include "devseg/pack/nest.h"

namespace devseg::pack {

namespace {

constexpr double cells_of_chart = 40.0;   // along the side of a square as large as a mean chart
constexpr double most_fit_cells = 2048.0; // along the square's side
constexpr double near_widths[] = {0.99, 1.01}; // in roots of the area of the first box
constexpr std::size_t remembered = 48;         // heights of the charts before
// One chart of so many looks for room below. Of many charts only so many do, as each looks at all
// rows again: 3,400 took a quarter of the time and 1.5 % more room; 2,000 would take 10 % more.
constexpr std::size_t look_below = 2;
constexpr std::size_t many_to_fit = 2500;
constexpr std::size_t most_looks = 150;
constexpr double fit_reserve = 1.02; // the side that the padding is a share of, at first
constexpr double fit_step = 1.05;

struct Images {
    double cell = 1.0;
    std::vector<std::vector<FitImage>> poses;
    std::vector<std::size_t> order;
    Index longest_run = 1;
};

Images make_images(const std::vector<Outline>& outlines, double cell, double margin,
                   bool allow_rotation, Progress& progress) {
    Images images;
    images.cell = cell;
    images.poses.resize(outlines.size());
    parallel_for(
        static_cast<int>(outlines.size()),
        [&](int i) {
            const double base = allow_rotation ? best_box_angle(outlines[i]) : 0.0;
            for (int k = 0; k < (allow_rotation ? few_orientations : 1); ++k)
                images.poses[i].emplace_back(
                    rasterize(outlines[i], base + 2.0 * pi * k / few_orientations, cell, margin));
        },
        progress);
    for (const auto& poses : images.poses)
        for (const FitImage& image : poses)
            for (const CellRun& run : image.runs)
                images.longest_run = std::max(images.longest_run, run.last - run.first);
    images.order.resize(outlines.size());
    std::iota(images.order.begin(), images.order.end(), std::size_t{0});
    std::stable_sort(images.order.begin(), images.order.end(), [&](std::size_t a, std::size_t b) {
        return images.poses[a].front().cells.count > images.poses[b].front().cells.count;
    });
    return images;
}

struct Found {
    std::vector<Placement> placements;
    Vec2 box = Vec2::Constant(infinite);
};

Found fill(const Images& images, double width, const Progress& progress) {
    Index columns = static_cast<Index>(width / images.cell);
    for (const auto& poses : images.poses) { // each chart fits in one orientation at least
        Index narrowest = std::numeric_limits<Index>::max();
        for (const FitImage& image : poses)
            narrowest = std::min(narrowest, image.cells.width);
        columns = std::max(columns, narrowest);
    }
    FreeCells sheet(columns, images.longest_run);
    Found found;
    found.placements.resize(images.poses.size());
    // Charts of about the same size find room at about the same height: only some look below.
    std::array<Index, remembered> recent{};
    const bool many = images.order.size() > many_to_fit;
    const std::size_t apart = many ? images.order.size() / most_looks : look_below;
    std::size_t count = 0;
    for (const std::size_t i : images.order) {
        progress.check();
        const bool looks_below = count++ % apart == 0;
        const Index lowest = looks_below ? 0 : *std::min_element(recent.begin(), recent.end());
        Spot spot;
        sheet.put(images.poses[i], lowest, std::numeric_limits<Index>::max(), spot);
        if (!looks_below || !many) // what was found below sends no other chart down
            recent[count % remembered] = spot.y;
        found.placements[i] = placement_of(images.poses[i][spot.pose].cells, spot, images.cell);
    }
    found.box = images.cell * Vec2(columns, sheet.height());
    return found;
}

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

std::vector<Placement> pack_first_fit(const std::vector<Outline>& outlines,
                                      const PackOptions& options, double side, Progress& progress) {
    const double count = static_cast<double>(outlines.size());
    for (double assumed = fit_reserve * side;; assumed *= fit_step) {
        const double cell = assumed / std::min(most_fit_cells, cells_of_chart * std::sqrt(count));
        auto pass = progress.part(0.7 * progress.left());
        auto drawing = pass.part(0.3);
        const Images images = make_images(outlines, cell, 0.5 * options.padding * assumed,
                                          options.allow_rotation, drawing);
        const auto fill_some = [&](const std::vector<double>& tried) {
            std::vector<Found> found(tried.size());
            auto filling = pass.part(0.35);
            parallel_for(
                static_cast<int>(tried.size()),
                [&](int k) { found[k] = fill(images, tried[k], filling); }, filling);
            return found;
        };
        Found best = fill_some({side}).front();
        const double even = std::sqrt(best.box.prod());
        for (Found& f : fill_some({near_widths[0] * even, near_widths[1] * even}))
            if (badness(f.box) < badness(best.box))
                best = std::move(f);
        if (best.box.maxCoeff() <= assumed)
            return best.placements;
        side = best.box.maxCoeff();
        assumed = std::max(assumed, side);
    }
}

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
    : width_(width), words_(at(width / word_bits) + 2),
      levels_(log2_floor(std::min(width, longest_run)) + 1), blocked_(words_) {}

bool FreeCells::put(const std::vector<FitImage>& poses, Index from, Index limit, Spot& spot) {
    return put(poses, {0, width_, from, limit - 1}, spot);
}

bool FreeCells::put(const std::vector<FitImage>& poses, FitWindow window, Spot& spot) {
    bool found = false;
    for (std::size_t pose = 0; pose < poses.size(); ++pose)
        if (find(poses[pose], window, spot)) {
            found = true;
            spot.pose = pose;
            window.top = spot.y + poses[pose].cells.height - 1;
        }
    if (found)
        take(poses[spot.pose], spot);
    return found;
}

bool FreeCells::find(const FitImage& image, const FitWindow& window, Spot& spot) {
    last_ = std::min(width_, window.right) - image.cells.width;
    if (last_ < window.left)
        return false;
    for (Index y = window.from; y < std::min(window.top, static_cast<Index>(room_.size())); ++y)
        bring_up_to_date(y);
    for (Index y = window.from; y <= window.top - image.cells.height; ++y)
        if (find_blocked(image, y, window.left)) {
            spot.x = first_free();
            spot.y = y;
            return true;
        }
    return false;
}

const std::vector<FreeCells::Word>* FreeCells::blocked(const FitImage& image, Index y) {
    last_ = width_ - image.cells.width;
    if (last_ < 0)
        return nullptr;
    const Index end = std::min(y + image.cells.height, static_cast<Index>(room_.size()));
    for (Index row = y; row < end; ++row)
        bring_up_to_date(row);
    std::fill(blocked_.begin(), blocked_.end(), ~Word{0});
    return find_blocked(image, y, 0) ? &blocked_ : nullptr;
}

// Calls task(word, mask) for the words of a row that hold a run's cells, while it returns true.
template <class Task>
bool FreeCells::all_words(const CellRun& run, Index x, const Task& task) {
    const Index first = x + run.first;
    const Index end = x + run.last;
    for (Index w = first / word_bits; w * word_bits < end; ++w) {
        Word mask = ~Word{0};
        if (w * word_bits < first)
            mask <<= first - w * word_bits;
        if ((w + 1) * word_bits > end)
            mask &= ~Word{0} >> ((w + 1) * word_bits - end);
        if (!task(at(w), mask))
            return false;
    }
    return true;
}

bool FreeCells::is_free(const FitImage& image, const Spot& spot) const {
    const auto rows = static_cast<Index>(room_.size());
    if (spot.x + image.cells.width > width_)
        return false;
    return std::all_of(image.runs.begin(), image.runs.end(), [&](const CellRun& run) {
        const Index row = spot.y + run.row;
        if (row >= rows)
            return true;
        const Word* words = bits_.data() + at(row) * at(levels_) * words_;
        return all_words(run, spot.x,
                         [&](std::size_t w, Word mask) { return (words[w] & mask) == 0; });
    });
}

void FreeCells::take(const FitImage& image, const Spot& spot) {
    const Index top = spot.y + image.cells.height;
    if (static_cast<Index>(room_.size()) < top) {
        bits_.resize(at(top) * at(levels_) * words_, 0);
        room_.resize(at(top), width_);
    }
    for (const CellRun& run : image.cells.runs) {
        Word* words = level(spot.y + run.row, 0);
        all_words(run, spot.x, [&](std::size_t w, Word mask) {
            words[w] |= mask;
            return true;
        });
        room_[at(spot.y + run.row)] = unknown;
    }
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
    if (room_[at(y)] != unknown)
        return;
    for (Index k = 1; k < levels_; ++k) {
        const Word* finer = level(y, k - 1);
        std::copy(finer, finer + words_, level(y, k));
        const Index shift = Index{1} << (k - 1);
        add_shifted(finer, shift, words_ - 1 - at(shift / word_bits), level(y, k));
    }
    const Word* row = level(y, 0);
    Index longest = 0;
    Index free = 0;
    for (Index x = 0; x < width_;) {
        const Word word = row[x / word_bits];
        if (word == 0 && x + word_bits <= width_) {
            free += word_bits;
            x += word_bits;
            longest = std::max(longest, free);
            continue;
        }
        for (const Index end = std::min(width_, x + word_bits); x < end; ++x) {
            free = (word >> (x % word_bits) & 1) != 0 ? 0 : free + 1;
            longest = std::max(longest, free);
        }
    }
    room_[y] = longest;
}

// Marks the places in row y, from `left` to `last_`, where the image lies on others; false if none
// is left.
bool FreeCells::find_blocked(const FitImage& image, Index y, Index left) {
    const auto rows = static_cast<Index>(room_.size());
    for (const CellRun& run : image.runs)
        if (y + run.row < rows && length(run) > room_[y + run.row])
            return false;
    const std::size_t count = at(last_ / word_bits) + 1;
    std::fill_n(blocked_.begin(), count, Word{0});
    std::fill_n(blocked_.begin(), left / word_bits, ~Word{0});
    blocked_[left / word_bits] = (Word{1} << (left % word_bits)) - 1; // no places there,
    blocked_[count - 1] |= ~Word{0} << (last_ % word_bits) << 1;      // nor there
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
