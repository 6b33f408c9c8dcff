#include "devseg/pack/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "devseg/plane/plane.h"

namespace devseg::pack {

namespace {

// Andrew's monotone chain, counterclockwise.
std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
    std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) {
        return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
    });
    points.erase(std::unique(points.begin(), points.end()), points.end());
    if (points.size() < 3)
        return points;
    std::vector<Vec2> hull;
    for (int side = 0; side < 2; ++side) {
        const std::size_t start = hull.size();
        for (const Vec2& p : points) {
            while (hull.size() >= start + 2 &&
                   plane::cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0.0)
                hull.pop_back();
            hull.push_back(p);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    return hull;
}

// Half of an edge's record, kept with its lower vertex.
struct Link {
    Index other;
    Index sign; // +1 runs from the lower to the other vertex, −1 the other way
};

// Added to the margin, in cells: far above the rounding of coordinates, far below any effect.
constexpr double rounding_slack = 1e-6;

// The least x of the points at distance ≤ m of segment ab at height y, for a.y ≤ b.y and a height
// where there are such points.
double left_end(const Vec2& a, const Vec2& b, const Vec2& direction, double m, double y) {
    const double rise = m * direction.x(); // of the left offset of the segment
    const auto disk = [&](const Vec2& c) {
        return c.x() - std::sqrt(std::max(0.0, m * m - (y - c.y()) * (y - c.y())));
    };
    if (y <= a.y() + rise)
        return disk(a);
    if (y >= b.y() + rise)
        return disk(b);
    return a.x() - m * direction.y() + (y - a.y() - rise) * (b.x() - a.x()) / (b.y() - a.y());
}

// The least x of these points in the slab low ≤ y ≤ high. The points form a convex set, whose left
// end is a convex function of y: its minimum is the leftmost point's, or at the slab's nearer side.
double slab_left(const Vec2& a, const Vec2& b, const Vec2& direction, double m, double low,
                 double high) {
    const double y = std::clamp(a.x() <= b.x() ? a.y() : b.y(), low, high);
    return left_end(a, b, direction, m, std::clamp(y, a.y() - m, b.y() + m));
}

// A bit image that is turned into runs; bytes are simple, and quick enough.
class Canvas {
public:
    Canvas(Index width, Index height)
        : width_(width), height_(height), set_(at(width) * at(height), 0) {}

    void fill(Index row, Index first, Index last) {
        first = std::max(first, Index{0});
        last = std::min(last, width_);
        if (row >= 0 && row < height_ && first < last)
            std::fill(set_.begin() + offset(row) + first, set_.begin() + offset(row) + last, 1);
    }

    ChartCells runs() const {
        ChartCells image;
        image.width = width_;
        image.height = height_;
        for (Index y = 0; y < height_; ++y) {
            const auto begin = set_.begin() + offset(y);
            const auto end = begin + width_;
            for (auto from = std::find(begin, end, 1); from != end;) {
                const auto to = std::find(from, end, 0);
                image.runs.push_back(
                    {y, static_cast<Index>(from - begin), static_cast<Index>(to - begin)});
                image.count += static_cast<Index>(to - from);
                from = std::find(to, end, 1);
            }
        }
        return image;
    }

private:
    std::ptrdiff_t offset(Index y) const { return static_cast<std::ptrdiff_t>(y) * width_; }

    Index width_;
    Index height_;
    std::vector<unsigned char> set_;
};

void draw_edge(Canvas& canvas, Vec2 a, Vec2 b, double m) {
    if (a.y() > b.y())
        std::swap(a, b);
    const double length = (b - a).norm();
    const Vec2 direction = length > 0.0 ? Vec2((b - a) / length) : Vec2(1.0, 0.0);
    const Vec2 mirror(-1.0, 1.0);
    const Index first = static_cast<Index>(std::floor(a.y() - m));
    const Index last = static_cast<Index>(std::floor(b.y() + m));
    for (Index y = first; y <= last; ++y) {
        const double left = slab_left(a, b, direction, m, y, y + 1.0);
        const double right = -slab_left(a.cwiseProduct(mirror), b.cwiseProduct(mirror),
                                        direction.cwiseProduct(mirror), m, y, y + 1.0);
        canvas.fill(y, static_cast<Index>(std::floor(left)),
                    static_cast<Index>(std::floor(right)) + 1);
    }
}

struct Crossing {
    Index row;
    Index column; // the first whose centre lies to the right
    Index sign;
};

// Fills the cells that no edge touches: they are inside as a whole when their centre is.
void fill_inside(Canvas& canvas, const std::vector<OutlineEdge>& edges) {
    std::vector<Crossing> crossings;
    for (const OutlineEdge& e : edges) {
        const bool up = e.from.y() < e.to.y();
        const Vec2& a = up ? e.from : e.to;
        const Vec2& b = up ? e.to : e.from;
        // Row centres with a.y ≤ y < b.y.
        for (Index y = static_cast<Index>(std::ceil(a.y() - 0.5)); y + 0.5 < b.y(); ++y) {
            const double x = a.x() + (b.x() - a.x()) * ((y + 0.5 - a.y()) / (b.y() - a.y()));
            crossings.push_back({y, static_cast<Index>(std::ceil(x - 0.5)), up ? 1 : -1});
        }
    }
    std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
        return a.row != b.row         ? a.row < b.row
               : a.column != b.column ? a.column < b.column
                                      : a.sign < b.sign;
    });
    Index winding = 0;
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
        winding += crossings[i].sign;
        if (crossings[i].row != crossings[i + 1].row)
            winding = 0;
        else if (winding != 0)
            canvas.fill(crossings[i].row, crossings[i].column, crossings[i + 1].column);
    }
}

// Depths at which the weight steps up. Their steps keep the sum close to the depth, with few runs.
constexpr Index depth_levels[] = {1, 2, 3, 4, 6, 8, 11, 15, 20, 26, 34};

// The cells of each depth or more, in city blocks from the nearest cell outside, as runs.
std::vector<WeightedRun> depth_runs(const ChartCells& image) {
    const Index stride = image.width + 2; // with a border outside
    std::vector<Index> depth(at(stride) * at(image.height + 2), 0);
    const auto cell = [&](Index x, Index y) -> Index& {
        return depth[at(y + 1) * at(stride) + at(x + 1)];
    };
    for (const CellRun& run : image.runs)
        for (Index x = run.first; x < run.last; ++x)
            cell(x, run.row) = 1 + std::min(cell(x - 1, run.row), cell(x, run.row - 1));
    for (auto run = image.runs.rbegin(); run != image.runs.rend(); ++run)
        for (Index x = run->last - 1; x >= run->first; --x)
            cell(x, run->row) = std::min(
                cell(x, run->row), 1 + std::min(cell(x + 1, run->row), cell(x, run->row + 1)));
    std::vector<WeightedRun> result;
    Index previous = 0;
    for (const Index level : depth_levels) {
        for (const CellRun& run : image.runs)
            for (Index x = run.first; x < run.last;) {
                const Index first = x;
                while (x < run.last && cell(x, run.row) >= level)
                    ++x;
                if (x > first)
                    result.push_back({{run.row, first, x}, level - previous});
                else
                    ++x;
            }
        previous = level;
    }
    return result;
}

} // namespace

Outline find_outline(const std::vector<Triangle>& faces, const std::vector<Vec2>& points) {
    Outline outline;
    std::vector<std::size_t> start(points.size() + 1, 0);
    for (const Triangle& t : faces)
        for (std::size_t k = 0; k < 3; ++k)
            ++start[at(std::min(t[k], t[(k + 1) % 3])) + 1];
    for (std::size_t v = 0; v < points.size(); ++v)
        start[v + 1] += start[v];
    std::vector<Link> links(3 * faces.size());
    std::vector<std::size_t> end(start.begin(), start.end() - 1);
    for (const Triangle& t : faces) {
        const double twice = plane::cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]);
        outline.area += 0.5 * std::abs(twice);
        const Index orientation = twice < 0.0 ? -1 : 1;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
            links[end[low]++] = {high, low == t[k] ? orientation : -orientation};
        }
    }
    std::vector<Vec2> corners;
    for (std::size_t v = 0; v < points.size(); ++v) {
        const auto first = links.begin() + static_cast<std::ptrdiff_t>(start[v]);
        const auto last = links.begin() + static_cast<std::ptrdiff_t>(start[v + 1]);
        std::sort(first, last, [](const Link& a, const Link& b) { return a.other < b.other; });
        for (auto link = first; link != last;) {
            const Index other = link->other;
            Index sum = 0;
            for (; link != last && link->other == other; ++link)
                sum += link->sign;
            for (; sum != 0; sum += sum > 0 ? -1 : 1) {
                const Vec2& a = points[v];
                const Vec2& b = points[other];
                outline.edges.push_back(sum > 0 ? OutlineEdge{a, b} : OutlineEdge{b, a});
                corners.push_back(a);
                corners.push_back(b);
            }
        }
    }
    // Without faces, or with triangles that cancel altogether: no extent, but still a place.
    if (corners.empty())
        corners.push_back(points.empty() ? Vec2(0.0, 0.0) : points.front());
    outline.hull = convex_hull(std::move(corners));
    return outline;
}

Outline outline_of(const std::vector<std::vector<Vec2>>& rings) {
    Outline outline;
    for (const std::vector<Vec2>& ring : rings) {
        outline.area += plane::signed_area(ring);
        for (std::size_t i = 0; i < ring.size(); ++i)
            outline.edges.push_back({ring[i], ring[(i + 1) % ring.size()]});
    }
    outline.hull = convex_hull(rings.front());
    return outline;
}

double best_box_angle(const Outline& outline) {
    const std::vector<Vec2>& hull = outline.hull;
    double best = 0.0;
    double best_area = std::numeric_limits<double>::max();
    // One side of the least box lies on an edge of the convex hull.
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Vec2 edge = hull[(i + 1) % hull.size()] - hull[i];
        const double length = edge.norm();
        if (!(length > 0.0))
            continue;
        const Vec2 along = edge / length;
        const Eigen::AlignedBox2d box = plane::box_of(
            hull, [&](const Vec2& p) { return Vec2(along.dot(p), plane::cross(along, p)); });
        const double area = box.sizes().prod();
        if (area < best_area) {
            best_area = area;
            best = -std::atan2(along.y(), along.x());
        }
    }
    return best;
}

ChartCells rasterize(const Outline& outline, double angle, double cell, double margin) {
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    const auto turned = [&](const Vec2& p) { return plane::turned(p, c, s); };
    const Eigen::AlignedBox2d box = plane::box_of(outline.hull, turned);
    const double m = margin / cell + rounding_slack;
    const Vec2 offset = Vec2::Constant(m * cell) - box.min();
    const auto cells = [&](double length) {
        return static_cast<Index>(std::floor(length / cell + 2.0 * m)) + 1;
    };
    Canvas canvas(cells(box.sizes().x()), cells(box.sizes().y()));
    std::vector<OutlineEdge> edges;
    edges.reserve(outline.edges.size());
    for (const OutlineEdge& e : outline.edges) {
        edges.push_back({(turned(e.from) + offset) / cell, (turned(e.to) + offset) / cell});
        draw_edge(canvas, edges.back().from, edges.back().to, m);
    }
    if (edges.empty())
        canvas.fill(0, 0, 1);
    fill_inside(canvas, edges);
    ChartCells image = canvas.runs();
    for (const CellRun& run : image.runs)
        image.obstacle.push_back({run, 1});
    image.cosine = c;
    image.sine = s;
    image.offset = offset;
    return image;
}

ChartCells coarsen(const ChartCells& fine, Index factor, double share) {
    const Index width = std::max(Index{1}, (fine.width + factor / 2) / factor);
    const Index height = std::max(Index{1}, (fine.height + factor / 2) / factor);
    std::vector<Index> covered(at(width) * at(height), 0);
    for (const CellRun& run : fine.runs) {
        const Index y = run.row / factor;
        const Index last = std::min(run.last, width * factor);
        for (Index x = run.first; y < height && x < last;) {
            const Index next = std::min(last, (x / factor + 1) * factor);
            covered[at(y) * at(width) + at(x / factor)] += next - x;
            x = next;
        }
    }
    Canvas canvas(width, height);
    const Index most = *std::max_element(covered.begin(), covered.end());
    // A chart thinner than the cells must not vanish.
    const Index enough = std::min(most, static_cast<Index>(std::ceil(share * factor * factor)));
    for (Index y = 0; y < height; ++y)
        for (Index x = 0; x < width; ++x)
            if (covered[at(y) * at(width) + at(x)] >= enough)
                canvas.fill(y, x, x + 1);
    ChartCells image = canvas.runs();
    image.obstacle = depth_runs(image);
    image.cosine = fine.cosine;
    image.sine = fine.sine;
    image.offset = fine.offset;
    return image;
}

} // namespace devseg::pack
