// References
//   K. Hormann, M. S. Floater: Mean value coordinates for arbitrary planar polygons. ACM
//   Transactions on Graphics 25(4), 2006: section 5, the weights without angles.
#include "sheet/carry_folds.h"

#include <algorithm>
#include <cmath>

#include "sheet/segment_grid.h"

namespace devseg {

namespace {

using Ring = std::vector<Vec2>;

// An outline before it was moved, and how far each of its points was.
struct MovedRing {
    Ring points;
    Ring moves;
};

MovedRing moved_ring(const PiecePath& path, const PaperMap& place, const CornerUv& uv) {
    MovedRing ring;
    for (std::size_t i = 0; i < path.points.size(); ++i) {
        const Index h = i < path.half_edge.size() ? path.half_edge[i] : -1;
        if (h < 0)
            continue; // a point that is none of the mesh
        ring.points.push_back(place(uv[at(h)]));
        ring.moves.push_back(path.points[i] - ring.points.back());
    }
    return ring;
}

double cross(const Vec2& a, const Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// The move at p: that of the outline on it, and a mean of all moves inside.
Vec2 interpolated(const std::vector<MovedRing>& rings, const Vec2& p) {
    Vec2 sum = Vec2::Zero();
    double weights = 0.0;
    for (const MovedRing& ring : rings)
        for (std::size_t i = 0; i < ring.points.size(); ++i) {
            const std::size_t j = (i + 1) % ring.points.size();
            const Vec2 a = ring.points[i] - p;
            const Vec2 b = ring.points[j] - p;
            const double r = a.norm();
            const double s = b.norm();
            if (r == 0.0)
                return ring.moves[i];
            const double area = cross(a, b);
            const double dot = a.dot(b);
            if (area == 0.0 && dot < 0.0) // on the edge
                return (s * ring.moves[i] + r * ring.moves[j]) / (r + s);
            if (area == 0.0)
                continue;
            const double half_tangent = (r * s - dot) / area;
            sum += half_tangent * (ring.moves[i] / r + ring.moves[j] / s);
            weights += half_tangent * (1.0 / r + 1.0 / s);
        }
    return weights != 0.0 ? Vec2(sum / weights) : Vec2::Zero();
}

} // namespace

void carry_folds(const CornerUv& uv, Pattern& pattern) {
    for (PatternPiece& piece : pattern.pieces) {
        std::vector<MovedRing> moved;
        std::vector<Ring> outlines;
        for (Index i = 0; i < piece.path_count(); ++i) {
            moved.push_back(moved_ring(piece.path(i), piece.place, uv));
            outlines.push_back(piece.path(i).points);
        }
        for (PieceFold& fold : piece.folds) {
            fold.from += interpolated(moved, fold.from);
            fold.to += interpolated(moved, fold.to);
        }
        const auto is_outside = [&](const PieceFold& fold) {
            return !is_inside(outlines, 0.5 * (fold.from + fold.to));
        };
        piece.folds.erase(std::remove_if(piece.folds.begin(), piece.folds.end(), is_outside),
                          piece.folds.end());
    }
}

} // namespace devseg
