#include "devseg/develop/intersections.h"

#include <algorithm>
#include <numeric>

#include <unsupported/Eigen/BVH>

namespace devseg::develop {

namespace {

double volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return (b - a).cross(c - a).dot(d - a);
}

// Does the segment p q run through the inside of the triangle a b c?
bool pierces(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
    const double at_p = volume(a, b, c, p);
    const double at_q = volume(a, b, c, q);
    if (!(at_p * at_q < 0.0))
        return false;
    const double u = volume(p, q, a, b);
    const double v = volume(p, q, b, c);
    const double w = volume(p, q, c, a);
    return (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0);
}

bool cross(const std::vector<Vec3>& points, const Triangle& s, const Triangle& t) {
    int common = 0;
    for (const Index a : s)
        common += static_cast<int>(std::count(t.begin(), t.end(), a));
    if (common >= 2)
        return false;
    const auto one_way = [&](const Triangle& from, const Triangle& through) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Index p = from[k];
            const Index q = from[(k + 1) % 3];
            // An edge that starts on the other triangle meets it there and nowhere else.
            if (std::count(through.begin(), through.end(), p) == 0 &&
                std::count(through.begin(), through.end(), q) == 0 &&
                pierces(points[p], points[q], points[through[0]], points[through[1]],
                        points[through[2]]))
                return true;
        }
        return false;
    };
    return one_way(s, t) || one_way(t, s);
}

// Collects the triangles behind triangle f that cross it, from a tree of boxes.
struct CrossingSearch {
    const std::vector<Vec3>& points;
    const std::vector<Triangle>& faces;
    const std::vector<Eigen::AlignedBox3d>& boxes; // of the triangles
    Face f;
    std::vector<std::pair<Index, Index>> pairs;

    bool intersectVolume(const Eigen::AlignedBox3d& box) const { return box.intersects(boxes[f]); }
    bool intersectObject(Index g) {
        if (g > f && boxes[g].intersects(boxes[f]) && cross(points, faces[f], faces[g]))
            pairs.emplace_back(f, g);
        return false; // there may be more
    }
};

} // namespace

std::vector<std::pair<Index, Index>> find_intersections(const std::vector<Vec3>& points,
                                                        const std::vector<Triangle>& faces,
                                                        const Progress& progress) {
    std::vector<Index> all(faces.size());
    std::iota(all.begin(), all.end(), 0);
    std::vector<Eigen::AlignedBox3d> boxes(faces.size());
    for (std::size_t f = 0; f < faces.size(); ++f)
        for (const Vertex v : faces[f])
            boxes[f].extend(points[v]);
    const Eigen::KdBVH<double, 3, Index> tree(all.begin(), all.end(), boxes.begin(), boxes.end());
    CrossingSearch search{points, faces, boxes, {}, {}};
    Heartbeat heartbeat(progress);
    for (const Index f : all) {
        heartbeat();
        search.f = f;
        if (all.size() > 1) // the tree needs two
            Eigen::BVIntersect(tree, search);
    }
    std::sort(search.pairs.begin(), search.pairs.end());
    return search.pairs;
}

} // namespace devseg::develop
