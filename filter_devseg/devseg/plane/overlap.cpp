#include "devseg/plane/overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "devseg/plane/plane.h"

namespace devseg::plane {

namespace {

// Neighbours that share an edge touch exactly; triangles that meet otherwise, as on both sides of
// a closed slit, reach into each other by rounding.
constexpr double touch_tolerance = 1e-6;
// Each corner is off by up to one step of a 32-bit number in the layout; a few of them add up.
constexpr double rounding_steps = 4.0;

using Corners = std::array<Vec2, 3>;

Corners corners_of(const CornerUv& uv, Index f) {
    Corners t{uv[3 * f], uv[3 * f + 1], uv[3 * f + 2]};
    if (uv_area(uv, f) < 0.0)
        std::swap(t[1], t[2]);
    return t;
}

double extent(const Corners& t) {
    const Vec2 low = t[0].cwiseMin(t[1]).cwiseMin(t[2]);
    const Vec2 high = t[0].cwiseMax(t[1]).cwiseMax(t[2]);
    return (high - low).maxCoeff();
}

// True when the line along one of a's edges separates the triangles.
bool separated_by_edges_of(const Corners& a, const Corners& b, double tolerance) {
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 edge = a[(k + 1) % 3] - a[k];
        const double length = edge.norm();
        if (!(length > 0.0))
            continue;
        const Vec2 inward(-edge.y() / length, edge.x() / length);
        double reach = -std::numeric_limits<double>::max(); // of b to a's side of the edge
        for (const Vec2& p : b)
            reach = std::max(reach, inward.dot(p - a[k]));
        if (reach <= tolerance)
            return true;
    }
    return false;
}

bool overlap(const Corners& a, const Corners& b, double least) {
    const double tolerance = std::max(least, touch_tolerance * std::min(extent(a), extent(b)));
    return !separated_by_edges_of(a, b, tolerance) && !separated_by_edges_of(b, a, tolerance);
}

// A uniform grid with about one cell for each face.
class Grid {
public:
    Grid(const CornerUv& uv, const std::vector<Index>& faces) {
        Vec2 high = uv[3 * faces.front()];
        low_ = high;
        for (const Index f : faces)
            for (Index k = 0; k < 3; ++k) {
                low_ = low_.cwiseMin(uv[3 * f + k]);
                high = high.cwiseMax(uv[3 * f + k]);
            }
        const Vec2 size = (high - low_).cwiseMax(1e-12 * (high - low_).maxCoeff());
        const double cells = std::max(1.0, static_cast<double>(faces.size()));
        cell_ = std::sqrt(size.prod() / cells);
        cell_ = std::max(cell_, size.maxCoeff() / (4.0 * cells));
        columns_ = static_cast<Index>(size.x() / cell_) + 1;
        rows_ = static_cast<Index>(size.y() / cell_) + 1;
        begin_.assign(at(columns_ * rows_) + 1, 0);
        for (const Index f : faces)
            visit(corners_of(uv, f), [&](Index c) { ++begin_[at(c) + 1]; });
        for (std::size_t c = 1; c < begin_.size(); ++c)
            begin_[c] += begin_[c - 1];
        items_.resize(at(begin_.back()));
        std::vector<Index> cursor(begin_.begin(), begin_.end() - 1);
        for (const Index f : faces)
            visit(corners_of(uv, f), [&](Index c) { items_[cursor[c]++] = f; });
    }
    Index cell_count() const { return columns_ * rows_; }
    const Index* first(Index c) const { return items_.data() + begin_[c]; }
    const Index* last(Index c) const { return items_.data() + begin_[at(c) + 1]; }

    /// The cell that owns a pair of faces: the one with the lowest corner of their common box.
    Index owner(const Corners& a, const Corners& b) const {
        const Vec2 low = lowest(a).cwiseMax(lowest(b));
        return column(low.x()) + columns_ * row(low.y());
    }

private:
    static Vec2 lowest(const Corners& t) { return t[0].cwiseMin(t[1]).cwiseMin(t[2]); }
    static Vec2 highest(const Corners& t) { return t[0].cwiseMax(t[1]).cwiseMax(t[2]); }
    Index column(double x) const {
        return std::clamp(static_cast<Index>((x - low_.x()) / cell_), Index{0}, columns_ - 1);
    }
    Index row(double y) const {
        return std::clamp(static_cast<Index>((y - low_.y()) / cell_), Index{0}, rows_ - 1);
    }
    template <class Visit>
    void visit(const Corners& t, Visit each) const {
        const Vec2 low = lowest(t);
        const Vec2 high = highest(t);
        for (Index y = row(low.y()); y <= row(high.y()); ++y)
            for (Index x = column(low.x()); x <= column(high.x()); ++x)
                each(x + columns_ * y);
    }

    Vec2 low_;
    double cell_ = 1.0;
    Index columns_ = 1;
    Index rows_ = 1;
    std::vector<Index> begin_;
    std::vector<Index> items_;
};

} // namespace

namespace {

// Calls each({f, g}), f < g, of the pairs that overlap, in no order, until it returns false.
template <class Each>
void visit_overlapping_pairs(const CornerUv& corners, double tolerance, Each each) {
    std::vector<Index> faces;
    for (Index f = 0; f < static_cast<Index>(corners.size() / 3); ++f)
        if (std::abs(uv_area(corners, f)) > 0.0) // false for NaN as well
            faces.push_back(f);
    if (faces.empty())
        return;
    const Grid grid(corners, faces);
    std::vector<Corners> in_cell;
    for (Index c = 0; c < grid.cell_count(); ++c) {
        in_cell.clear();
        for (const Index* f = grid.first(c); f != grid.last(c); ++f)
            in_cell.push_back(corners_of(corners, *f));
        for (std::size_t i = 0; i < in_cell.size(); ++i)
            for (std::size_t j = i + 1; j < in_cell.size(); ++j)
                if (grid.owner(in_cell[i], in_cell[j]) == c &&
                    overlap(in_cell[i], in_cell[j], tolerance) &&
                    !each(std::minmax(grid.first(c)[i], grid.first(c)[j])))
                    return;
    }
}

} // namespace

std::vector<std::pair<Index, Index>> find_overlapping_pairs(const CornerUv& corners,
                                                            double tolerance) {
    std::vector<std::pair<Index, Index>> pairs;
    visit_overlapping_pairs(corners, tolerance, [&](const std::pair<Index, Index>& pair) {
        pairs.push_back(pair);
        return true;
    });
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

bool any_overlap(const CornerUv& corners, double tolerance) {
    bool any = false;
    visit_overlapping_pairs(corners, tolerance, [&](const std::pair<Index, Index>&) {
        any = true;
        return false;
    });
    return any;
}

double layout_tolerance(double extent) {
    return rounding_steps * static_cast<double>(std::numeric_limits<float>::epsilon()) * extent;
}

std::vector<std::uint8_t> find_overlapping_faces(const CornerUv& uv) {
    Vec2 low = Vec2::Zero();
    Vec2 high = Vec2::Zero();
    for (const Vec2& p : uv) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    std::vector<std::uint8_t> result(uv.size() / 3, 0);
    for (const auto& [f, g] : find_overlapping_pairs(uv, layout_tolerance((high - low).maxCoeff())))
        result[f] = result[g] = 1;
    return result;
}

} // namespace devseg::plane
