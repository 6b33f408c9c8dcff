#include "devseg/curves/face_cutting.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace devseg::curves {

namespace {

using Ring = std::vector<Index>;

double smallest_angle(const Vec2& a, const Vec2& b, const Vec2& c) {
    const auto cross = [](const Vec2& u, const Vec2& v) { return u.x() * v.y() - u.y() * v.x(); };
    const double area = cross(b - a, c - a);
    double least = pi;
    const Vec2* p[] = {&a, &b, &c};
    for (int k = 0; k < 3; ++k)
        least = std::min(least,
                         std::atan2(area, (*p[(k + 1) % 3] - *p[k]).dot(*p[(k + 2) % 3] - *p[k])));
    return least;
}

std::ptrdiff_t position(const Ring& ring, Index point) {
    const auto found = std::find(ring.begin(), ring.end(), point);
    return found == ring.end() ? -1 : found - ring.begin();
}

// Splits the ring that has both ends of the path, along it. Lines of the ring's own are there.
bool split(std::vector<Ring>& rings, const std::vector<Index>& path) {
    for (std::size_t r = 0; r < rings.size(); ++r) {
        Ring& ring = rings[r];
        const std::ptrdiff_t i = position(ring, path.front());
        const std::ptrdiff_t j = position(ring, path.back());
        if (i < 0 || j < 0 || i == j)
            continue;
        const auto count = static_cast<std::ptrdiff_t>(ring.size());
        if (path.size() == 2 && ((i + 1) % count == j || (j + 1) % count == i))
            return true;
        std::rotate(ring.begin(), ring.begin() + i, ring.end());
        const std::ptrdiff_t middle = (j - i + count) % count;
        Ring first(ring.begin(), ring.begin() + middle + 1); // from the path's start to its end
        Ring second(ring.begin() + middle, ring.end());
        for (std::size_t k = path.size() - 1; k-- > 1;)
            first.push_back(path[k]);
        second.push_back(path.front()); // and on to its start
        for (std::size_t k = 1; k + 1 < path.size(); ++k)
            second.push_back(path[k]);
        rings[r] = std::move(first);
        rings.push_back(std::move(second));
        return true;
    }
    return false;
}

// Triangulates a ring so that the smallest angle is largest: the best triangle on each diagonal.
double triangulate(const CutFace& face, const Ring& ring, std::vector<Triangle>& parts) {
    const std::size_t n = ring.size();
    if (n < 3)
        return -pi;
    std::vector<std::vector<double>> best(n, std::vector<double>(n, pi));
    std::vector<std::vector<std::size_t>> apex(n, std::vector<std::size_t>(n, 0));
    for (std::size_t width = 2; width < n; ++width)
        for (std::size_t i = 0; i + width < n; ++i) {
            const std::size_t j = i + width;
            best[i][j] = -2.0 * pi;
            for (std::size_t k = i + 1; k < j; ++k) {
                const double angle =
                    std::min({smallest_angle(face.points[ring[i]], face.points[ring[k]],
                                             face.points[ring[j]]),
                              best[i][k], best[k][j]});
                if (angle > best[i][j]) {
                    best[i][j] = angle;
                    apex[i][j] = k;
                }
            }
        }
    std::vector<std::pair<std::size_t, std::size_t>> stack{{0, n - 1}};
    while (!stack.empty()) {
        const auto [i, j] = stack.back();
        stack.pop_back();
        if (j < i + 2)
            continue;
        const std::size_t k = apex[i][j];
        parts.push_back({ring[i], ring[k], ring[j]});
        stack.emplace_back(i, k);
        stack.emplace_back(k, j);
    }
    return best[0][n - 1];
}

} // namespace

FaceParts cut_face(const CutFace& face) {
    FaceParts result;
    std::vector<Ring> rings{face.ring};
    std::vector<std::uint8_t> placed(face.points.size(), 0);
    for (const Index p : face.ring)
        placed[p] = 1;
    std::vector<std::pair<Index, Index>> later;
    for (const auto& [a, b] : face.lines)
        if (placed[a] == 0 || placed[b] == 0)
            later.emplace_back(a, b);
        else if (!split(rings, {a, b}))
            return result;
    // A point inside comes in on its way between two points that are there; then its other lines.
    for (Index p = 0; p < static_cast<Index>(face.points.size()); ++p) {
        if (placed[p] != 0)
            continue;
        std::vector<Index> ends;
        for (const auto& [a, b] : later)
            if ((a == p || b == p) && placed[a == p ? b : a] != 0)
                ends.push_back(a == p ? b : a);
        if (ends.size() < 2 || !split(rings, {ends[0], p, ends[1]}))
            return result;
        placed[p] = 1;
        for (std::size_t k = 2; k < ends.size(); ++k)
            if (!split(rings, {p, ends[k]}))
                return result;
    }
    result.smallest_angle = pi;
    for (const Ring& ring : rings)
        result.smallest_angle =
            std::min(result.smallest_angle, triangulate(face, ring, result.parts));
    result.sound = result.smallest_angle > 0.0;
    return result;
}

} // namespace devseg::curves
