#include "devseg/pack/proximity.h"

#include <algorithm>

#include "devseg/plane/plane.h"

namespace devseg::pack {

namespace {

constexpr double most_cells = 128.0; // along the longer side of the box

} // namespace

std::size_t Proximity::column(double x) const {
    return static_cast<std::size_t>(
        std::clamp((x - low_.x()) / cell_, 0.0, static_cast<double>(columns_ - 1)));
}

std::size_t Proximity::row(double y) const {
    return static_cast<std::size_t>(
        std::clamp((y - low_.y()) / cell_, 0.0, static_cast<double>(rows_ - 1)));
}

// The cells that the box of an edge, grown by the reach, touches.
template <typename Visit>
void Proximity::visit_cells(const PlacedEdge& e, Visit visit) const {
    const Vec2 low = e.from.cwiseMin(e.to) - Vec2::Constant(reach_);
    const Vec2 high = e.from.cwiseMax(e.to) + Vec2::Constant(reach_);
    const std::size_t left = column(low.x());
    const std::size_t right = column(high.x());
    const std::size_t top = row(high.y());
    for (std::size_t y = row(low.y()); y <= top; ++y)
        for (std::size_t x = left; x <= right; ++x)
            visit(y * columns_ + x);
}

void Proximity::fill(const std::vector<PlacedEdge>& edges, const Eigen::AlignedBox2d& box) {
    low_ = box.min();
    cell_ = std::max(2.0 * reach_, box.sizes().maxCoeff() / most_cells);
    columns_ = static_cast<std::size_t>(box.sizes().x() / cell_) + 1;
    rows_ = static_cast<std::size_t>(box.sizes().y() / cell_) + 1;
    // Counting leaves room for one more start: filling moves them to the ends of their cells.
    starts_.assign(columns_ * rows_ + 2, 0);
    for (const PlacedEdge& e : edges)
        visit_cells(e, [&](std::size_t c) { ++starts_[c + 2]; });
    for (std::size_t c = 2; c < starts_.size(); ++c)
        starts_[c] += starts_[c - 1];
    listed_.resize(starts_.back());
    for (std::size_t k = 0; k < edges.size(); ++k)
        visit_cells(edges[k], [&](std::size_t c) { listed_[starts_[c + 1]++] = k; });
}

// Pairs with the vertex where an edge begins.
void Proximity::find_near(const std::vector<PlacedEdge>& edges, std::size_t vertex) {
    const Vec2& p = edges[vertex].from;
    const std::size_t chart = edges[vertex].chart;
    const std::size_t c = row(p.y()) * columns_ + column(p.x());
    near_.clear();
    for (std::size_t k = starts_[c]; k < starts_[c + 1]; ++k) {
        const PlacedEdge& other = edges[listed_[k]];
        if (other.chart == chart)
            continue;
        const double distance = (p - plane::nearest_point(p, other.from, other.to)).squaredNorm();
        if (!(distance < reach_ * reach_))
            continue;
        Nearest& nearest = nearest_[other.chart];
        const bool first = nearest.vertex != vertex + 1;
        if (first)
            near_.push_back(other.chart);
        if (first || distance < nearest.distance)
            nearest = {distance, listed_[k], vertex + 1};
    }
    for (const std::size_t b : near_) {
        const PlacedEdge& other = edges[nearest_[b].edge];
        const Vec2 q = plane::nearest_point(p, other.from, other.to);
        const double distance = (p - q).norm();
        Vec2 normal(0.0, 0.0);
        if (distance > 0.0) {
            normal = (p - q) / distance;
        } else {
            // They touch; the inside of an edge is on its left.
            normal = Vec2(other.to.y() - other.from.y(), other.from.x() - other.to.x());
            normal = normal.squaredNorm() > 0.0 ? Vec2(normal.normalized()) : Vec2(1.0, 0.0);
        }
        pairs_.push_back({chart, b, p, q, normal, distance});
    }
}

const std::vector<ClosePair>& Proximity::find(const std::vector<PlacedEdge>& edges,
                                              const Eigen::AlignedBox2d& box, std::size_t charts,
                                              double reach) {
    reach_ = reach;
    pairs_.clear();
    fill(edges, box);
    nearest_.assign(charts, {});
    for (std::size_t k = 0; k < edges.size(); ++k)
        find_near(edges, k);
    return pairs_;
}

} // namespace devseg::pack
