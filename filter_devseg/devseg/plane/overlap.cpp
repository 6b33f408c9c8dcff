#include "devseg/plane/overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "devseg/plane/plane.h"

namespace devseg::plane {

namespace {

// Neighbours that share an edge touch exactly; triangles that meet otherwise, as on both sides of
// a closed slit, reach into each other by rounding.
constexpr double touch_tolerance = 1e-6;
// Each corner is off by up to one step of a 32-bit number in the layout; a few of them add up.
constexpr double rounding_steps = 4.0;

using Corners = std::array<Vec2, 3>;

// A face counterclockwise, with what many tests ask of it.
struct Triangle {
    Triangle(const CornerUv& uv, Index f) : corners{uv[3 * f], uv[3 * f + 1], uv[3 * f + 2]} {
        if (uv_area(uv, f) < 0.0)
            std::swap(corners[1], corners[2]);
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec2 edge = corners[(k + 1) % 3] - corners[k];
            const double length = edge.norm();
            inward[k] = length > 0.0 ? Vec2(-edge.y() / length, edge.x() / length) : Vec2::Zero();
        }
        for (const Vec2& p : corners)
            box.extend(p);
    }
    double extent() const { return box.sizes().maxCoeff(); }

    Corners corners;
    std::array<Vec2, 3> inward; // unit normals of the edges; 0 for edges without length
    Eigen::AlignedBox2d box;
};

// True when the line along one of a's edges separates the triangles.
bool separated_by_edges_of(const Triangle& a, const Triangle& b, double tolerance) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (a.inward[k].isZero(0.0))
            continue;
        double reach = -std::numeric_limits<double>::max(); // of b to a's side of the edge
        for (const Vec2& p : b.corners)
            reach = std::max(reach, a.inward[k].dot(p - a.corners[k]));
        if (reach <= tolerance)
            return true;
    }
    return false;
}

bool overlap(const Triangle& a, const Triangle& b, double least) {
    const double tolerance = std::max(least, touch_tolerance * std::min(a.extent(), b.extent()));
    return !separated_by_edges_of(a, b, tolerance) && !separated_by_edges_of(b, a, tolerance);
}

// Boxes of faces in grids of cells of 1, 2, 4, … times a width: a face lies in the first one whose
// cells are as large as its box, in at most four of them. Long faces, as those of plates with
// holes, would lie in many cells of one grid, and meet each other in all of them.
class BoxLevels {
public:
    explicit BoxLevels(const std::vector<Triangle>& faces) {
        boxes_.reserve(faces.size());
        Box all;
        double sum = 0.0;
        for (const Triangle& face : faces) {
            all.extend(face.box);
            sum += face.extent();
            boxes_.push_back(face.box);
        }
        low_ = all.min();
        const double count = static_cast<double>(faces.size());
        // No more cells than faces.
        width_ = std::max(
            {sum / count, std::sqrt(all.sizes().prod() / count), all.sizes().maxCoeff() / count});
        std::vector<std::vector<Index>> members;
        level_.resize(faces.size());
        for (std::size_t i = 0; i < faces.size(); ++i) {
            std::size_t level = 0;
            for (double w = width_; w < boxes_[i].sizes().maxCoeff(); w *= 2.0)
                ++level;
            level_[i] = level;
            members.resize(std::max(members.size(), level + 1));
            members[level].push_back(static_cast<Index>(i));
        }
        for (std::size_t l = 0; l < members.size(); ++l)
            add_level(all, members[l], std::ldexp(width_, static_cast<int>(l)));
    }

    /// Calls each(i, j) once for all pairs of boxes that meet, numbers in `faces`, until it returns
    /// false.
    template <class Each>
    bool visit_pairs(Each each) const {
        for (std::size_t i = 0; i < boxes_.size(); ++i)
            for (std::size_t l = level_[i]; l < levels_.size(); ++l)
                if (!visit_pairs_with(static_cast<Index>(i), l, each))
                    return false;
        return true;
    }

private:
    using Box = Eigen::AlignedBox2d;

    struct Level {
        double width = 1.0;
        Index columns = 1;
        Index rows = 1;
        std::vector<Index> begin; // of each cell in `items`
        std::vector<Index> items;
        std::vector<Box> boxes; // of the items, side by side
    };

    Index column(const Level& level, double x) const {
        return std::clamp(static_cast<Index>((x - low_.x()) / level.width), Index{0},
                          level.columns - 1);
    }
    Index row(const Level& level, double y) const {
        return std::clamp(static_cast<Index>((y - low_.y()) / level.width), Index{0},
                          level.rows - 1);
    }

    template <class Visit>
    bool visit_cells(const Level& level, const Box& box, Visit each) const {
        const Index last_row = row(level, box.max().y());
        const Index last_column = column(level, box.max().x());
        for (Index y = row(level, box.min().y()); y <= last_row; ++y)
            for (Index x = column(level, box.min().x()); x <= last_column; ++x)
                if (!each(x + level.columns * y))
                    return false;
        return true;
    }

    void add_level(const Box& all, const std::vector<Index>& members, double width) {
        Level level;
        level.width = width;
        level.columns = static_cast<Index>(all.sizes().x() / width) + 1;
        level.rows = static_cast<Index>(all.sizes().y() / width) + 1;
        if (!members.empty()) {
            level.begin.assign(at(level.columns * level.rows) + 1, 0);
            const auto visit_all = [&](const auto& each) {
                for (const Index i : members)
                    visit_cells(level, boxes_[at(i)], [&](Index c) {
                        each(i, at(c));
                        return true;
                    });
            };
            visit_all([&](Index, std::size_t c) { ++level.begin[c + 1]; });
            for (std::size_t c = 1; c < level.begin.size(); ++c)
                level.begin[c] += level.begin[c - 1];
            level.items.resize(at(level.begin.back()));
            std::vector<Index> cursor(level.begin.begin(), level.begin.end() - 1);
            visit_all([&](Index i, std::size_t c) { level.items[at(cursor[c]++)] = i; });
            for (const Index i : level.items)
                level.boxes.push_back(boxes_[at(i)]);
        }
        levels_.push_back(std::move(level));
    }

    // With those of a level, which are larger, or as large and come later.
    template <class Each>
    bool visit_pairs_with(Index i, std::size_t l, Each each) const {
        const Level& level = levels_[l];
        if (level.items.empty())
            return true;
        const Box& box = boxes_[at(i)];
        const bool same = level_[at(i)] == l;
        return visit_cells(level, box, [&](Index c) {
            const auto first = level.items.begin() + level.begin[at(c)];
            const auto last = level.items.begin() + level.begin[at(c) + 1];
            // In their order in each cell.
            for (auto item = same ? std::upper_bound(first, last, i) : first; item != last;
                 ++item) {
                const Box& other =
                    level.boxes[static_cast<std::size_t>(item - level.items.begin())];
                if (!box.intersects(other))
                    continue;
                const Index j = *item;
                // The cell with the lowest corner of their common box has the pair.
                const Vec2 low = box.min().cwiseMax(other.min());
                if (column(level, low.x()) + level.columns * row(level, low.y()) == c &&
                    !each(i, j))
                    return false;
            }
            return true;
        });
    }

    Vec2 low_;
    double width_ = 1.0;
    std::vector<Box> boxes_;
    std::vector<std::size_t> level_; // of each box
    std::vector<Level> levels_;
};

// Calls each({f, g}), f < g, of the pairs that overlap, in no order, until it returns false.
template <class Each>
void visit_overlapping_pairs(const CornerUv& corners, double tolerance, Each each) {
    std::vector<Index> faces;
    std::vector<Triangle> triangles;
    for (Index f = 0; f < static_cast<Index>(corners.size() / 3); ++f)
        if (std::abs(uv_area(corners, f)) > 0.0) { // false for NaN as well
            faces.push_back(f);
            triangles.emplace_back(corners, f);
        }
    if (faces.empty())
        return;
    BoxLevels(triangles).visit_pairs([&](Index i, Index j) {
        return !overlap(triangles[at(i)], triangles[at(j)], tolerance) ||
               each(std::minmax(faces[at(i)], faces[at(j)]));
    });
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
