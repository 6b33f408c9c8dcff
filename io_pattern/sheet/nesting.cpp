#include "sheet/nesting.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "devseg/pack/outline_raster.h"
#include "devseg/pack/place_search.h"
#include "devseg/plane/plane.h"

namespace devseg::sheet {

namespace {

constexpr double cells_across = 320.0; // of a sheet's width
// Turns that are tried for the least box around a piece, within a quarter.
constexpr int box_turns = 30;

pack::Outline outline_of(const SheetPiece& piece) {
    pack::Outline outline;
    for (const std::vector<Vec2>& ring : piece.cut)
        for (std::size_t i = 0; i < ring.size(); ++i)
            outline.edges.push_back({ring[i], ring[(i + 1) % ring.size()]});
    outline.hull = piece.cut.front(); // only its box is asked for
    return outline;
}

Vec2 turned_size(const std::vector<Vec2>& points, double angle) {
    return plane::box_of(points, [&](const Vec2& p) { return Eigen::Rotation2Dd(angle) * p; })
        .sizes();
}

double least_box_angle(const std::vector<Vec2>& points) {
    double best = 0.0;
    double least = std::numeric_limits<double>::max();
    for (int i = 0; i < box_turns; ++i) {
        const double angle = 0.5 * pi * i / box_turns;
        const double area = turned_size(points, angle).prod();
        if (area < least * (1.0 - 1e-9)) {
            least = area;
            best = angle;
        }
    }
    return best;
}

Index width(const pack::CellRun& run) {
    return run.last - run.first;
}

// Free cells of one sheet: for each cell, how many from it to the right are free.
class Board {
public:
    Board(Index columns, Index rows, bool grows) : columns_(columns), rows_(0), grows_(grows) {
        if (!grows)
            add_rows(rows);
    }

    /// The lowest place, then the leftmost, whose top is below `limit`; false where there is none.
    bool find(const pack::ChartCells& cells, Index limit, pack::Spot& spot) {
        if (cells.width > columns_)
            return false;
        const pack::CellRun longest = *std::max_element(
            cells.runs.begin(), cells.runs.end(),
            [](const pack::CellRun& a, const pack::CellRun& b) { return width(a) < width(b); });
        const Index last = grows_ ? rows_ : rows_ - cells.height;
        for (Index y = 0; y <= last && y + cells.height < limit; ++y) {
            add_rows(y + cells.height);
            if (widest_[y + longest.row] < width(longest) || !has_room(cells, y))
                continue;
            for (Index x = 0; x + cells.width <= columns_;) {
                const Index next = blocked_until(cells, x, y);
                if (next == x) {
                    spot.x = x;
                    spot.y = y;
                    return true;
                }
                x = next;
            }
        }
        return false;
    }

    void occupy(const pack::ChartCells& cells, const pack::Spot& spot) {
        for (const pack::CellRun& run : cells.runs) {
            Index* row = free_.data() + offset(spot.y + run.row);
            std::fill(row + spot.x + run.first, row + spot.x + run.last, 0);
            for (Index x = spot.x + run.first - 1; x >= 0 && row[x] != 0; --x)
                row[x] = spot.x + run.first - x;
            widest_[spot.y + run.row] = *std::max_element(row, row + columns_);
        }
    }

private:
    // Whether each row has somewhere as many free cells as the run that comes there.
    bool has_room(const pack::ChartCells& cells, Index y) const {
        return std::all_of(cells.runs.begin(), cells.runs.end(), [&](const pack::CellRun& run) {
            return widest_[y + run.row] >= width(run);
        });
    }

    // The next column to try; x itself where all runs are free.
    Index blocked_until(const pack::ChartCells& cells, Index x, Index y) const {
        for (const pack::CellRun& run : cells.runs) {
            const Index room = free_[static_cast<Index>(offset(y + run.row)) + x + run.first];
            if (room < width(run))
                return x + room + 1;
        }
        return x;
    }

    void add_rows(Index rows) {
        for (; rows_ < rows; ++rows_) {
            for (Index x = 0; x < columns_; ++x)
                free_.push_back(columns_ - x);
            widest_.push_back(columns_);
        }
    }
    std::size_t offset(Index y) const { return at(y) * at(columns_); }

    Index columns_;
    Index rows_;
    bool grows_;
    std::vector<Index> free_;
    std::vector<Index> widest_; // of each row, the most free cells side by side
};

// The poses that fit on an empty sheet: images of far larger ones would take all memory there is.
std::vector<pack::ChartCells> poses_of(const SheetPiece& piece, const NestingOptions& options,
                                       double cell) {
    const bool grows = options.height <= 0.0;
    const pack::Outline outline = outline_of(piece);
    double angle = least_box_angle(piece.cut.front());
    int turns = 4;
    const Vec2 grain = piece.grain_line[1] - piece.grain_line[0];
    if (options.keep_grain && grain != Vec2::Zero()) {
        angle = 0.5 * pi - std::atan2(grain.y(), grain.x());
        turns = 2;
    }
    std::vector<pack::ChartCells> poses;
    for (int i = 0; i < turns; ++i) {
        const double turn = angle + 2.0 * pi * i / turns;
        const Vec2 size = turned_size(piece.cut.front(), turn);
        if (size.x() > options.width + cell || (!grows && size.y() > options.height + cell))
            continue;
        poses.push_back(pack::rasterize(outline, turn, cell, 0.5 * options.gap));
    }
    return poses;
}

double box_area(const SheetPiece& piece) {
    return piece.box().sizes().prod();
}

} // namespace

Nesting nest_pieces(const std::vector<const SheetPiece*>& pieces, const NestingOptions& options,
                    Progress& progress) {
    const double cell = options.width / cells_across;
    // Half of the gap around each piece may lie outside of the sheet.
    const auto cells = [&](double length) {
        return static_cast<Index>(std::floor((length + options.gap) / cell));
    };
    std::vector<std::size_t> order(pieces.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return box_area(*pieces[a]) > box_area(*pieces[b]);
    });
    Nesting nesting;
    nesting.placements.resize(pieces.size());
    nesting.sheet.assign(pieces.size(), -1);
    std::vector<Board> boards;
    const bool grows = options.height <= 0.0;
    std::size_t done = 0;
    for (const std::size_t i : order) {
        progress.update(static_cast<double>(done++) / static_cast<double>(order.size()));
        const std::vector<pack::ChartCells> poses = poses_of(*pieces[i], options, cell);
        for (std::size_t b = 0; b <= boards.size() && nesting.sheet[i] < 0; ++b) {
            Board fresh(cells(options.width), grows ? 0 : cells(options.height), grows);
            Board& board = b < boards.size() ? boards[b] : fresh;
            pack::Spot best;
            Index top = std::numeric_limits<Index>::max();
            for (std::size_t pose = 0; pose < poses.size(); ++pose) {
                pack::Spot spot{pose, 0, 0};
                if (board.find(poses[pose], top, spot)) {
                    best = spot;
                    top = spot.y + poses[pose].height;
                }
            }
            if (top == std::numeric_limits<Index>::max())
                continue;
            const pack::ChartCells& image = poses[best.pose];
            board.occupy(image, best);
            nesting.sheet[i] = static_cast<Index>(b);
            nesting.placements[i] = {image.cosine, image.sine,
                                     image.offset + cell * Vec2(best.x, best.y) -
                                         Vec2::Constant(0.5 * options.gap)};
            if (b == boards.size())
                boards.push_back(std::move(fresh));
            break;
        }
    }
    nesting.sheet_count = static_cast<Index>(boards.size());
    return nesting;
}

} // namespace devseg::sheet
