#include "devseg/develop/intersections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace devseg::develop {

namespace {

struct Box {
    Vec3 low = Vec3::Constant(infinite);
    Vec3 high = -low;

    void add(const Vec3& p) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    bool meets(const Box& o) const {
        return (low.array() <= o.high.array()).all() && (o.low.array() <= high.array()).all();
    }
};

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

// A tree of boxes over the triangles, halved at the middle of their order along the longest axis.
class BoxTree {
public:
    BoxTree(const std::vector<Vec3>& points, const std::vector<Triangle>& faces)
        : boxes_(faces.size()), order_(faces.size()) {
        for (std::size_t f = 0; f < faces.size(); ++f) {
            order_[f] = static_cast<Index>(f);
            for (const Vertex v : faces[f])
                boxes_[f].add(points[v]);
        }
        nodes_.reserve(2 * faces.size() / leaf_size + 2);
        build(0, faces.size());
    }

    template <class Visit>
    void visit_meeting(Face f, Visit visit) const {
        std::vector<std::size_t> stack{0};
        while (!stack.empty()) {
            const Node& node = nodes_[stack.back()];
            stack.pop_back();
            if (!node.box.meets(boxes_[f]))
                continue;
            if (node.left == 0) {
                for (std::size_t i = node.begin; i < node.end; ++i)
                    if (order_[i] > f && boxes_[order_[i]].meets(boxes_[f]))
                        visit(order_[i]);
            } else {
                stack.push_back(node.left);
                stack.push_back(node.right);
            }
        }
    }

private:
    static constexpr std::size_t leaf_size = 4;
    struct Node {
        Box box;
        std::size_t begin = 0, end = 0, left = 0, right = 0;
    };

    std::size_t build(std::size_t begin, std::size_t end) {
        const std::size_t index = nodes_.size();
        nodes_.emplace_back();
        Box box;
        for (std::size_t i = begin; i < end; ++i) {
            box.add(boxes_[order_[i]].low);
            box.add(boxes_[order_[i]].high);
        }
        std::size_t left = 0;
        std::size_t right = 0;
        if (end - begin > leaf_size) {
            Eigen::Index axis = 0;
            (box.high - box.low).maxCoeff(&axis);
            const std::size_t middle = (begin + end) / 2;
            const auto key = [&](Face f) { return boxes_[f].low[axis] + boxes_[f].high[axis]; };
            std::nth_element(order_.begin() + static_cast<std::ptrdiff_t>(begin),
                             order_.begin() + static_cast<std::ptrdiff_t>(middle),
                             order_.begin() + static_cast<std::ptrdiff_t>(end),
                             [&](Index a, Index b) { return key(a) < key(b); });
            left = build(begin, middle);
            right = build(middle, end);
        }
        nodes_[index] = {box, begin, end, left, right};
        return index;
    }

    std::vector<Box> boxes_;
    std::vector<Index> order_;
    std::vector<Node> nodes_;
};

} // namespace

std::vector<std::pair<Index, Index>> find_intersections(const std::vector<Vec3>& points,
                                                        const std::vector<Triangle>& faces,
                                                        const Progress& progress) {
    const BoxTree tree(points, faces);
    std::vector<std::pair<Index, Index>> pairs;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        if (f % 1024 == 0)
            progress.check();
        tree.visit_meeting(static_cast<Index>(f), [&](Index g) {
            if (cross(points, faces[f], faces[g]))
                pairs.emplace_back(static_cast<Index>(f), g);
        });
    }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

} // namespace devseg::develop
