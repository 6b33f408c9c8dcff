#include "devseg/pack/shelves.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "devseg/plane/plane.h"

namespace devseg::pack {

namespace {

constexpr double side_step = 1.01; // the side is searched up to this factor

// A chart lying on its longer side, its box's corner at the origin.
struct Boxed {
    Placement placement;
    Vec2 size = Vec2::Zero();
};

Boxed lay_down(const Outline& outline, bool allow_rotation) {
    constexpr double quarter = pi / 2.0;
    Boxed boxed;
    double angle = allow_rotation ? best_box_angle(outline) : 0.0;
    for (int attempt = 0; attempt < 2; ++attempt, angle += quarter) {
        boxed.placement.cosine = std::cos(angle);
        boxed.placement.sine = std::sin(angle);
        boxed.placement.offset = Vec2::Zero();
        const Eigen::AlignedBox2d box = plane::box_of(outline.hull, boxed.placement);
        boxed.placement.offset = -box.min();
        boxed.size = box.sizes();
        if (!allow_rotation || boxed.size.x() >= boxed.size.y())
            break;
    }
    return boxed;
}

// Whether the boxes, which keep a gap, fit into a square with half of the gap along its border.
bool fill_shelves(const std::vector<Boxed>& boxes, const std::vector<std::size_t>& order,
                  double side, double gap, std::vector<Placement>& placements) {
    Vec2 corner = Vec2::Zero();
    double shelf = 0.0;
    for (const std::size_t i : order) {
        const Vec2 size = boxes[i].size + Vec2::Constant(gap);
        if (corner.x() > 0.0 && corner.x() + size.x() > side) {
            corner = Vec2(0.0, corner.y() + shelf);
            shelf = 0.0;
        }
        if (corner.x() + size.x() > side || corner.y() + size.y() > side)
            return false;
        placements[i].offset = boxes[i].placement.offset + corner;
        corner.x() += size.x();
        shelf = std::max(shelf, size.y());
    }
    return true;
}

} // namespace

std::vector<Placement> pack_on_shelves(const std::vector<Outline>& outlines,
                                       const PackOptions& options, double side,
                                       Progress& progress) {
    std::vector<Boxed> boxes;
    std::vector<Placement> placements;
    for (const Outline& outline : outlines) {
        progress.update(0.5);
        boxes.push_back(lay_down(outline, options.allow_rotation));
        placements.push_back(boxes.back().placement);
    }
    if (outlines.size() == 1)
        return placements;
    std::vector<std::size_t> order(boxes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return boxes[a].size.y() > boxes[b].size.y();
    });
    while (!fill_shelves(boxes, order, side, options.padding * side, placements)) {
        progress.update(0.8);
        side *= side_step;
    }
    return placements;
}

} // namespace devseg::pack
