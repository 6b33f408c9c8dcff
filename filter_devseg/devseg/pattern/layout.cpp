#include "devseg/pattern/layout.h"

#include <algorithm>

#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// Distance of pieces that had to be moved, as a share of the layout's size.
constexpr double shelf_gap = 0.02;

// Even-odd rule over all outlines.
bool is_inside(const PatternPiece& piece, const Vec2& p) {
    bool inside = false;
    for (Index l = 0; l < piece.path_count(); ++l)
        inside = inside != plane::is_inside(piece.path(l).points, p);
    return inside;
}

// Edges that come near the box.
std::vector<std::array<Vec2, 2>> edges_in(const PatternPiece& piece,
                                          const Eigen::AlignedBox2d& box) {
    std::vector<std::array<Vec2, 2>> edges;
    for (Index l = 0; l < piece.path_count(); ++l) {
        const std::vector<Vec2>& points = piece.path(l).points;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Vec2& a = points[i];
            const Vec2& b = points[(i + 1) % points.size()];
            if (box.intersects(Eigen::AlignedBox2d(a.cwiseMin(b), a.cwiseMax(b))))
                edges.push_back({a, b});
        }
    }
    return edges;
}

bool boundaries_cross(const PatternPiece& a, const PatternPiece& b) {
    const Eigen::AlignedBox2d common = a.box.intersection(b.box);
    const auto other_edges = edges_in(b, common);
    for (const auto& edge : edges_in(a, common))
        for (const auto& other : other_edges)
            if (plane::segments_cross(edge[0], edge[1], other[0], other[1]))
                return true;
    return false;
}

} // namespace

void move_piece(PatternPiece& piece, const Vec2& offset) {
    for (Index l = 0; l < piece.path_count(); ++l) {
        for (Vec2& p : piece.path(l).points)
            p += offset;
        for (OutlineCurve& curve : piece.path(l).curves)
            for (Vec2& p : curve.control)
                p += offset;
    }
    for (PieceFold& fold : piece.folds) {
        fold.from += offset;
        fold.to += offset;
    }
    for (Vec2& p : piece.grain)
        p += offset;
    piece.label_position += offset;
    piece.strain.worst_place += offset;
    piece.place.offset += offset;
    piece.box.translate(offset);
}

Eigen::AlignedBox2d bounding_box(const std::vector<PatternPiece>& pieces) {
    Eigen::AlignedBox2d box;
    for (const PatternPiece& piece : pieces)
        box.extend(piece.box);
    return box;
}

bool overlap(const PatternPiece& a, const PatternPiece& b) {
    if (a.box.intersection(b.box).isEmpty())
        return false;
    return is_inside(b, a.label_position) || is_inside(a, b.label_position) ||
           boundaries_cross(a, b);
}

std::vector<std::size_t> overlapping_pieces(const std::vector<PatternPiece>& pieces) {
    std::vector<std::size_t> result;
    std::vector<std::size_t> clear;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const bool is_clear = std::none_of(clear.begin(), clear.end(), [&](std::size_t j) {
            return overlap(pieces[i], pieces[j]);
        });
        (is_clear ? clear : result).push_back(i);
    }
    return result;
}

void shelve(std::vector<PatternPiece>& pieces, std::vector<std::size_t> moved) {
    if (moved.empty())
        return;
    std::stable_sort(moved.begin(), moved.end(), [&](std::size_t a, std::size_t b) {
        return pieces[a].box.sizes().y() > pieces[b].box.sizes().y();
    });
    const Eigen::AlignedBox2d layout = bounding_box(pieces);
    const double gap = shelf_gap * layout.sizes().maxCoeff();
    Vec2 corner(layout.min().x(), layout.max().y() + gap);
    double row_height = 0.0;
    for (const std::size_t i : moved) {
        const Vec2 size = pieces[i].box.sizes();
        if (corner.x() > layout.min().x() && corner.x() + size.x() > layout.max().x()) {
            corner = Vec2(layout.min().x(), corner.y() + row_height + gap);
            row_height = 0.0;
        }
        move_piece(pieces[i], corner - pieces[i].box.min());
        corner.x() += size.x() + gap;
        row_height = std::max(row_height, size.y());
    }
}

} // namespace devseg::pattern
