#include "sheet/page_fine.h"

#include <cmath>
#include <cstdint>

namespace devseg::sheet {

namespace {

struct Tuning {
    double work = 1e8;          // cells that are looked at
    double almost_empty = 0.05; // of a page: it is hardly worth the paper
};
constexpr Tuning tuning;
constexpr double turn = 1.5 * pi / 180.0;
constexpr int turns = 2; // to each side
constexpr pack::SeparationOptions moves{7, 2 * turns + 1, 40};

std::vector<const pack::ChartCells*> pointers(const std::vector<pack::ChartCells>& images) {
    std::vector<const pack::ChartCells*> result;
    for (const pack::ChartCells& image : images)
        result.push_back(&image);
    return result;
}

// A coarse place in the problem's cells.
pack::Spot fine_spot(const PageProblem& problem, const PageGrid& from, const PageGrid& grid,
                     bool is_large, const pack::ChartCells& image, pack::Spot spot) {
    pack::Window coarse{0, 0, 0, 0};
    pack::Window fine{0, 0, 0, 0};
    if (!is_large) {
        const Index page = from.page_of(image, spot);
        coarse = from.clear(page);
        fine = grid.clear(page);
    }
    return {turns, fine.left + problem.factor * (spot.x - coarse.left),
            fine.bottom + problem.factor * (spot.y - coarse.bottom)};
}

// The piece as it lies, and turned a little.
pack::ChartPoses turned(const PageProblem& problem, std::size_t i, const pack::ChartCells& image,
                        std::size_t pose) {
    const double angle = std::atan2(image.sine, image.cosine);
    pack::ChartPoses poses;
    for (int k = -turns; k <= turns; ++k)
        poses.push_back(k == 0 ? problem.poses[i][pose].cells
                               : pack::rasterize(problem.outlines[i], angle + k * turn,
                                                 problem.cell, 0.5 * piece_gap));
    return poses;
}

} // namespace

Index goal_of(const PageProblem& problem, const std::vector<Index>& covered, double cell) {
    const double least = tuning.almost_empty * problem.page_area() / (cell * cell);
    Index goal = 0;
    for (const Index cells : covered)
        goal += cells == 0 ? 0 : cells < least ? 3 : 1;
    return goal;
}

Index goal_of(const PageProblem& problem, const PageLayout& layout) {
    const PageGrid grid(problem, layout.columns, layout.rows, layout.singles, 1);
    return goal_of(problem, grid.cover(pointers(layout.images), layout.spots).cells, problem.cell);
}

std::optional<PageLayout> refined(const PageProblem& problem,
                                  const std::vector<pack::ChartPoses>& coarse,
                                  const CoarseLayout& found, const Progress& progress) {
    const PageGrid from(problem, found.columns, found.rows, found.singles, problem.factor);
    const PageGrid grid(problem, found.columns, found.rows, found.singles, 1);
    std::vector<const pack::ChartCells*> images;
    std::vector<pack::ChartPoses> charts;
    pack::Layout spots;
    for (std::size_t i = 0; i < coarse.size(); ++i) {
        progress.check();
        const pack::Spot& spot = found.spots[i];
        images.push_back(&coarse[i][spot.pose]);
        charts.push_back(turned(problem, i, *images[i], spot.pose));
        spots.push_back(fine_spot(problem, from, grid, problem.is_large[i] != 0, *images[i], spot));
    }
    std::vector<std::uint8_t> is_open;
    for (const Index cells : from.cover(images, found.spots).cells)
        is_open.push_back(cells > 0 ? 1 : 0);
    pack::Spot spot;
    charts.push_back({grid.closed(is_open, spot)});
    spots.push_back(spot);
    pack::Separation separation(charts, 1, progress);
    separation.confine(grid.windows(is_open, charts.back().front(), spot));
    auto work = static_cast<std::int64_t>(tuning.work);
    if (!separation.run(spots, {grid.sheet().right + 1, grid.sheet().top + 1}, moves, work))
        return {};
    PageLayout result{found.columns, found.rows, found.singles, {}, {}, {}};
    for (std::size_t i = 0; i < coarse.size(); ++i) {
        result.images.push_back(charts[i][spots[i].pose]);
        result.spots.push_back(spots[i]);
        result.page.push_back(
            problem.is_large[i] != 0 ? -1 : grid.page_of(result.images.back(), spots[i]));
    }
    return result;
}

} // namespace devseg::sheet
