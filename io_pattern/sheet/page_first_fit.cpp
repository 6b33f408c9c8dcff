#include "sheet/page_first_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace devseg::sheet {

namespace {

// Of the images of a piece, those of quarter turns.
std::vector<std::size_t> few_poses(const std::vector<pack::FitImage>& all) {
    std::vector<std::size_t> few;
    for (std::size_t k = 0; k < all.size(); k += std::max<std::size_t>(1, all.size() / 4))
        few.push_back(k);
    return few;
}

} // namespace

PageLayout first_fit(const PageProblem& problem, Index columns, const Progress& progress) {
    const std::size_t count = problem.poses.size();
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return problem.area[a] > problem.area[b];
    });
    PageLayout layout{columns, 0, 0, {}, {}, {}};
    layout.images.resize(count);
    layout.spots.resize(count);
    layout.page.assign(count, -1);
    Index longest = 1;
    for (const auto& poses : problem.poses)
        for (const pack::FitImage& image : poses)
            longest = std::max(longest, image.cells.width);
    const PageGrid one_row(problem, columns, 1, 0, 1);
    const Index width = one_row.sheet().right + 1;
    pack::FreeCells board(std::max(width, columns * problem.columns), longest);
    const auto put = [&](std::size_t i, pack::FreeCells& cells, const pack::FitWindow& window) {
        const std::vector<std::size_t> poses = few_poses(problem.poses[i]);
        std::vector<pack::FitImage> few;
        for (const std::size_t pose : poses)
            few.push_back(problem.poses[i][pose]);
        if (!cells.put(few, window, layout.spots[i]))
            return false;
        layout.spots[i].pose = poses[layout.spots[i].pose];
        layout.images[i] = problem.poses[i][layout.spots[i].pose].cells;
        return true;
    };
    for (const std::size_t i : order)
        if (problem.is_large[i] != 0) {
            progress.check();
            put(i, board, {0, width});
        }
    while (PageGrid(problem, columns, layout.rows, 0, 1).sheet().top + 1 < board.height())
        ++layout.rows;
    const PageGrid grid(problem, columns, layout.rows, static_cast<Index>(count), 1);
    std::vector<Index> parts = grid.empty_parts();
    for (std::size_t i = 0; i < count; ++i)
        if (problem.is_large[i] != 0)
            grid.count(layout.images[i], layout.spots[i], parts);
    const std::vector<Index> owner = cover_parts(columns, layout.rows, parts);
    std::vector<Index> pages;
    for (Index page = 0; page < grid.pages(); ++page)
        if (page >= grid.glued() || std::find(owner.begin(), owner.end(), page) != owner.end())
            pages.push_back(page);
    for (const std::size_t i : order) {
        progress.check();
        for (const Index page : pages) {
            if (problem.is_large[i] != 0)
                break;
            const pack::Window w = grid.clear(page);
            if (!put(i, board, {w.left, w.right + 1, w.bottom, w.top + 1}))
                continue;
            layout.page[i] = page;
            break;
        }
    }
    layout.singles = static_cast<Index>(count);
    return layout;
}

std::array<Index, 2> columns_of(const PageProblem& problem, double covered) {
    double large = 0.0;
    Index widest = 0;
    for (std::size_t i = 0; i < problem.poses.size(); ++i) {
        if (problem.is_large[i] == 0)
            continue;
        large += problem.area[i];
        Index least = problem.poses[i].front().cells.width;
        for (const std::size_t pose : few_poses(problem.poses[i]))
            least = std::min(least, problem.poses[i][pose].cells.width);
        widest = std::max(widest, least);
    }
    Index columns = 1;
    while (PageGrid(problem, columns, 1, 0, 1).sheet().right < widest)
        ++columns;
    const Vec2 step = problem.page.step();
    const double pages = large / (covered * problem.page_area());
    return {columns, static_cast<Index>(std::lround(std::sqrt(pages * step.y() / step.x())))};
}

} // namespace devseg::sheet
