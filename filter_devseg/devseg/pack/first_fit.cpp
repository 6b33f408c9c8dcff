#include "devseg/pack/first_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "devseg/base/parallel.h"
#include "devseg/pack/compaction.h"
#include "devseg/pack/free_cells.h"

namespace devseg::pack {

namespace {

constexpr double cells_of_chart = 40.0; // along the side of a square as large as a mean chart
constexpr double most_cells = 2048.0;   // along the square's side
constexpr int orientations = 8;
constexpr double near_widths[] = {0.99, 1.01}; // in roots of the area of the first box
constexpr std::size_t remembered = 48;         // heights of the charts before
constexpr std::size_t look_below = 2;          // one chart of so many
constexpr double padding_reserve = 1.02;       // the side that the padding is a share of, at first
constexpr double padding_step = 1.05;

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
            for (int k = 0; k < (allow_rotation ? orientations : 1); ++k)
                images.poses[i].emplace_back(
                    rasterize(outlines[i], base + 2.0 * pi * k / orientations, cell, margin));
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
    std::size_t count = 0;
    for (const std::size_t i : images.order) {
        progress.check();
        const Index lowest =
            count % look_below == 0 ? 0 : *std::min_element(recent.begin(), recent.end());
        Spot spot;
        sheet.put(images.poses[i], lowest, std::numeric_limits<Index>::max(), spot);
        recent[count++ % remembered] = spot.y;
        found.placements[i] = placement_of(images.poses[i][spot.pose].cells, spot, images.cell);
    }
    found.box = images.cell * Vec2(columns, sheet.height());
    return found;
}

} // namespace

std::vector<Placement> pack_first_fit(const std::vector<Outline>& outlines,
                                      const PackOptions& options, double side, Progress& progress) {
    const double count = static_cast<double>(outlines.size());
    for (double assumed = padding_reserve * side;; assumed *= padding_step) {
        const double cell = assumed / std::min(most_cells, cells_of_chart * std::sqrt(count));
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

} // namespace devseg::pack
