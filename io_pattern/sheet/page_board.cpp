#include "sheet/page_board.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace devseg::sheet {

namespace {

pack::FitImage rectangle(const pack::Window& window) {
    pack::ChartCells cells;
    cells.width = window.right - window.left + 1;
    cells.height = window.top - window.bottom + 1;
    for (Index y = 0; y < cells.height; ++y)
        cells.runs.push_back({y, 0, cells.width});
    return pack::FitImage(std::move(cells));
}

// The best of all that was offered, each of its equals as likely.
class Choice {
public:
    explicit Choice(Dice& dice) : dice_(dice) {}

    void offer(std::size_t pose, Index y, std::pair<Index, Index> pages, const Bits& places) {
        if (pages > least_)
            return;
        if (pages < least_)
            seen_ = 0;
        least_ = pages;
        const Index count = count_bits(places);
        seen_ += at(count);
        if (dice_.below(seen_) >= at(count))
            return;
        best_ = {pose, nth_bit(places, static_cast<Index>(dice_.below(at(count)))), y};
    }
    Index fewest_new() const { return least_.first; }
    std::optional<pack::Spot> best() const {
        return seen_ > 0 ? std::optional(best_) : std::nullopt;
    }

private:
    static constexpr Index most = std::numeric_limits<Index>::max();
    Dice& dice_;
    std::pair<Index, Index> least_{most, most}; // new pages, all pages
    std::size_t seen_ = 0;
    pack::Spot best_;
};

} // namespace

// The places of an image in one row.
struct PageBoard::Row {
    explicit Row(std::size_t words)
        : places(words), reached(words), new_pages(words), all_pages(words) {}

    Index y = 0;
    Bits places; // that are free
    Bits reached;
    PlaceCounts new_pages;
    PlaceCounts all_pages;
};

BoardPiece board_piece(const PageProblem& problem, std::size_t piece, double enough) {
    BoardPiece result;
    const pack::Window page = PageGrid(problem, 3, 3, 0, problem.factor).own(4); // the middle one
    for (const pack::FitImage& fine : problem.poses[piece]) {
        result.images.emplace_back(pack::coarsen(fine.cells, problem.factor, enough));
        if (problem.is_large[piece] != 0)
            result.reaches.emplace_back(result.images.back().cells, page.right - page.left + 1,
                                        page.top - page.bottom + 1);
    }
    return result;
}

PageBoard::PageBoard(const PageProblem& problem, const std::vector<BoardPiece>& pieces,
                     Index columns, Index rows)
    : problem_(&problem), pieces_(&pieces),
      grid_(problem, columns, rows,
            static_cast<Index>(std::count(problem.is_large.begin(), problem.is_large.end(), 0)),
            problem.factor),
      spots_(pieces.size()), is_there_(pieces.size(), 0), page_(pieces.size(), -1),
      parts_(pieces.size(), grid_.empty_parts()) {
    for (Index page = 0; page < grid_.pages(); ++page) {
        clear_.push_back(grid_.clear(page));
        width_ = std::max(width_, clear_.back().right + 1);
        height_ = std::max(height_, clear_.back().top + 1);
        if (page < grid_.glued())
            own_.push_back(grid_.own(page));
    }
    for (const BoardPiece& piece : pieces)
        for (const pack::FitImage& image : piece.images)
            for (const pack::CellRun& run : image.runs)
                longest_run_ = std::max(longest_run_, run.last - run.first);
}

void PageBoard::lay(std::size_t piece, const pack::Spot& spot) {
    const pack::ChartCells& image = (*pieces_)[piece].images[spot.pose].cells;
    spots_[piece] = spot;
    is_there_[piece] = 1;
    const Index page = problem_->is_large[piece] != 0 ? -1 : grid_.page_of(image, spot);
    page_[piece] = page >= grid_.glued() ? page : -1;
    std::fill(parts_[piece].begin(), parts_[piece].end(), 0);
    if (page_[piece] < 0)
        grid_.count(image, spot, parts_[piece]);
}

std::vector<Index> PageBoard::covered() const {
    std::vector<Index> cells(at(grid_.pages()), 0);
    std::vector<Index> parts = grid_.empty_parts();
    for (std::size_t i = 0; i < spots_.size(); ++i) {
        if (is_there_[i] == 0)
            continue;
        if (page_[i] >= 0)
            cells[at(page_[i])] += (*pieces_)[i].images[spots_[i].pose].cells.count;
        for (std::size_t k = 0; k < parts.size(); ++k)
            parts[k] += parts_[i][k];
    }
    const std::vector<Index> owner = cover_parts(grid_.columns(), grid_.rows(), parts);
    for (std::size_t k = 0; k < parts.size(); ++k)
        if (owner[k] >= 0)
            cells[at(owner[k])] += parts[k];
    return cells;
}

std::vector<std::size_t> PageBoard::pieces_on(Index page) const {
    const Index part =
        2 * (page / grid_.columns()) * parts_of(grid_.columns()) + 2 * (page % grid_.columns());
    std::vector<std::size_t> pieces;
    for (std::size_t i = 0; i < spots_.size(); ++i)
        if (page < grid_.glued() ? parts_[i][at(part)] > 0 : page_[i] == page)
            pieces.push_back(i);
    return pieces;
}

pack::FreeCells PageBoard::taken(Index closed) const {
    pack::FreeCells cells(width_, std::max(longest_run_, width_));
    for (std::size_t i = 0; i < spots_.size(); ++i)
        if (is_there_[i] != 0)
            cells.take((*pieces_)[i].images[spots_[i].pose], spots_[i]);
    if (closed >= 0) {
        const pack::Window& page = closed < grid_.glued() ? own_[at(closed)] : clear_[at(closed)];
        cells.take(rectangle(page), {0, page.left, page.bottom});
    }
    return cells;
}

// Where the piece may lie at all; false: nowhere in this row.
bool PageBoard::allow(std::size_t piece, const pack::ChartCells& image, Index closed,
                      const std::vector<Index>& covered, Row& row) const {
    std::fill(row.places.begin(), row.places.end(), 0);
    row.new_pages.clear();
    row.all_pages.clear();
    if (problem_->is_large[piece] != 0) {
        const pack::Window sheet = grid_.sheet();
        set_bits(row.places, 0, sheet.right + 2 - image.width);
        return row.y + image.height <= sheet.top + 1 && image.width <= sheet.right + 1;
    }
    bool is_allowed = false;
    for (Index page = 0; page < grid_.pages(); ++page) {
        const pack::Window& window = clear_[at(page)];
        if (page == closed || row.y < window.bottom || row.y + image.height > window.top + 1 ||
            window.left + image.width > window.right + 1)
            continue;
        is_allowed = true;
        std::fill(row.reached.begin(), row.reached.end(), 0);
        set_bits(row.reached, window.left, window.right + 2 - image.width);
        for (std::size_t k = 0; k < row.places.size(); ++k)
            row.places[k] |= row.reached[k];
        if (covered[at(page)] == 0)
            row.new_pages.add(row.reached);
    }
    return is_allowed;
}

// Strips are printed on pages that are there anyway.
void PageBoard::count_pages(const Reach& reach, const std::vector<Index>& covered, Row& row,
                            double& work) const {
    for (Index page = 0; page < grid_.glued(); ++page) {
        std::fill(row.reached.begin(), row.reached.end(), 0);
        const pack::Window& own = own_[at(page)];
        if (!reach.add_places(own.left, own.bottom, row.y, row.reached))
            continue;
        if (covered[at(page)] == 0)
            row.new_pages.add(row.reached);
        row.all_pages.add(row.reached);
        work -= 4.0 * static_cast<double>(row.places.size());
    }
}

std::optional<pack::Spot> PageBoard::find_place(std::size_t piece,
                                                const std::vector<std::size_t>& images,
                                                Index closed, Dice& dice, double& work) const {
    const std::vector<Index> pages = covered();
    pack::FreeCells cells = taken(closed);
    Row row(words_for(width_));
    Choice choice(dice);
    for (const std::size_t pose : images) {
        const pack::FitImage& image = (*pieces_)[piece].images[pose];
        for (row.y = 0; row.y + image.cells.height <= height_; ++row.y) {
            if (!allow(piece, image.cells, closed, pages, row))
                continue;
            work -= 2.0 * static_cast<double>(row.places.size() * image.runs.size());
            const Bits* blocked = cells.blocked(image, row.y);
            if (blocked == nullptr)
                continue;
            for (std::size_t k = 0; k < row.places.size(); ++k)
                row.places[k] &= ~(*blocked)[k];
            if (!any_bit(row.places))
                continue;
            if (problem_->is_large[piece] != 0)
                count_pages((*pieces_)[piece].reaches[pose], pages, row, work);
            const Index fresh = row.new_pages.keep_least(row.places);
            if (fresh <= choice.fewest_new()) {
                const Index all = row.all_pages.keep_least(row.places);
                choice.offer(pose, row.y, {fresh, all}, row.places);
            }
        }
    }
    return choice.best();
}

} // namespace devseg::sheet
