// Many charts, or pieces on sheets: each at the lowest free place on a grid, the largest first.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "devseg/pack/outline.h"
#include "devseg/pack/pack.h"
#include "devseg/pack/separation.h"

namespace devseg::pack {

/// Lays the charts out one after the other, at least options.padding times the square's side apart,
/// in a nearly square box. Several widths are tried; the work grows with the number of charts, and
/// not with its square. `side` is a guess of the square's. Throws Cancelled.
std::vector<Placement> pack_first_fit(const std::vector<Outline>& outlines,
                                      const PackOptions& options, double side, Progress& progress);

/// One orientation of a chart. Rows that are next to each other meet the same obstacles: `runs` are
/// the image's in an order that has early ones far apart, which shows soonest that there is no
/// room.
struct FitImage {
    explicit FitImage(ChartCells image);

    ChartCells cells;
    std::vector<CellRun> runs;
};

constexpr double sheet_cells = 320.0; // along a sheet of pieces: fine enough for hands and scissors

/// Where a chart may lie on a grid: columns left … right − 1, rows from … top − 1.
struct FitWindow {
    Index left = 0;
    Index right = std::numeric_limits<Index>::max();
    Index from = 0;
    Index top = std::numeric_limits<Index>::max();
};

/// Rows of cells, and for each power of two 2^k whether any of the 2^k cells from one on is taken.
/// As many rows as are needed.
class FreeCells {
public:
    using Word = std::uint64_t;

    /// `longest_run` of all images, cells.
    FreeCells(Index width, Index longest_run);

    /// Puts a chart, in the pose that ends lowest, at its lowest place from row `from` on, then the
    /// leftmost, whose top is below `limit`. False where there is none.
    bool put(const std::vector<FitImage>& poses, Index from, Index limit, Spot& spot);
    /// The same within a window.
    bool put(const std::vector<FitImage>& poses, FitWindow window, Spot& spot);

    /// The lowest place of one image in the window, then the leftmost. Nothing is put there.
    bool find(const FitImage& image, const FitWindow& window, Spot& spot);
    /// A bit for each place of an image in row y, from column 0 on, and more: 1 where it lies on
    /// others or beyond the width. Nothing where no place is free. Valid until the next call.
    const std::vector<Word>* blocked(const FitImage& image, Index y);
    /// Whether one place of an image is free and within the width.
    bool is_free(const FitImage& image, const Spot& spot) const;
    void take(const FitImage& image, const Spot& spot);

    Index height() const { return height_; }

private:
    static constexpr Index word_bits = 64;

    Word* level(Index y, Index k) { return bits_.data() + (at(y) * at(levels_) + at(k)) * words_; }
    template <class Task>
    static bool all_words(const CellRun& run, Index x, const Task& task);
    static void add_shifted(const Word* from, Index shift, std::size_t count, Word* to);
    bool find_blocked(const FitImage& image, Index y, Index left);
    Index first_free() const;
    void bring_up_to_date(Index y);

    Index width_;
    std::size_t words_; // of a row, one more than it needs
    Index levels_;
    Index height_ = 0;
    Index last_ = 0;                     // the last place of the image that is looked at
    std::vector<Word> bits_;             // row by row, level by level
    std::vector<Index> room_;            // #rows: the most free cells in a line, or
    static constexpr Index unknown = -1; // the row has changed, and higher levels have not
    std::vector<Word> blocked_;
};

} // namespace devseg::pack
