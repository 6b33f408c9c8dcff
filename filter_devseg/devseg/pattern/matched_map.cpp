// References
//   K. Hormann, M. S. Floater: Mean value coordinates for arbitrary planar polygons. ACM
//   Transactions on Graphics 25(4), 2006: section 5, the weights without angles.
#include "devseg/pattern/matched_map.h"

#include <cmath>
#include <utility>

#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

using Ring = std::vector<Vec2>;

// Moves below this share of the piece's size are rounding.
constexpr double no_move = 1e-9;

// An outline before it was moved, and how far each of its points was.
struct MovedRing {
    Ring points;
    Ring moves;
};

MovedRing moved_ring(const PiecePath& path, const PaperMap& place, const CornerUv& uv) {
    MovedRing ring;
    for (std::size_t i = 0; i < path.points.size(); ++i) {
        ring.points.push_back(place(uv[path.half_edge[i]]));
        ring.moves.push_back(path.points[i] - ring.points.back());
    }
    return ring;
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
            const double area = plane::cross(a, b);
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

std::vector<Vec2> place_corners(const Mesh& mesh, const CornerUv& uv,
                                const std::vector<Index>& faces, const PatternPiece& piece) {
    std::vector<MovedRing> moved;
    bool any = false;
    for (Index i = 0; i < piece.path_count(); ++i) {
        moved.push_back(moved_ring(piece.path(i), piece.place, uv));
        for (const Vec2& move : moved.back().moves)
            any = any || move.norm() > no_move * piece.box.sizes().norm();
    }
    // Corners at one vertex are mostly one place: the last one is remembered.
    std::vector<std::pair<Vec2, Vec2>> known; // before and after
    std::vector<Index> entry(any ? mesh.points.size() : 0, -1);
    std::vector<Vec2> corners;
    for (const Face f : faces)
        for (Index k = 0; k < 3; ++k) {
            const Vec2 p = piece.place(uv[3 * f + k]);
            if (!any) {
                corners.push_back(p);
                continue;
            }
            Index& last = entry[mesh.faces[f][k]];
            if (last < 0 || known[last].first != p) {
                last = static_cast<Index>(known.size());
                known.emplace_back(p, p + interpolated(moved, p));
            }
            corners.push_back(known[last].second);
        }
    return corners;
}

} // namespace devseg::pattern
