#include "devseg/pattern/split.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "devseg/graph/min_cut.h"
#include "devseg/pattern/shapes.h"

namespace devseg::pattern {

namespace {

// A cut at the edge of the stretch costs so much more than one of the same length in its middle:
// it leaves parts that are as large as allowed, and no play for further cuts.
constexpr double edge_cost = 0.5;

// The cut may move to find a short way, by this share of the allowed length at least, and not so
// far that it takes off a mere tip.
constexpr double least_play = 0.05;
constexpr double most_play = 0.15;

struct CutLine {
    Vec2 along; // unit, across the cut
    double low; // the cut lies between these places along it
    double high;
};

// Where to cut a part of the given length so that both sides need as few further cuts as possible.
CutLine choose_line(const PieceBox& box, double start, double longest) {
    const double parts = std::ceil(box.long_side / longest);
    const double before = std::floor(0.5 * parts);
    const double low = box.long_side - (parts - before) * longest;
    const double high = before * longest;
    const double middle = 0.5 * (low + high);
    const double half = std::clamp(0.5 * (high - low), least_play * longest, most_play * longest);
    return {box.direction, start + middle - half, start + middle + half};
}

// Which faces of the chart lie before the shortest cut near the line.
std::vector<graph::CutSide> sides_of(const atlas::ChartSurface& surface, const CornerUv& uv,
                                     const CutLine& line) {
    std::vector<double> place;
    for (const Face f : surface.face)
        place.push_back(line.along.dot(uv[3 * f] + uv[3 * f + 1] + uv[3 * f + 2]) / 3.0);
    const auto [first, last] = std::minmax_element(place.begin(), place.end());
    std::vector<graph::CutSide> sides(place.size(), graph::CutSide::open);
    for (std::size_t f = 0; f < place.size(); ++f)
        if (place[f] < line.low)
            sides[f] = graph::CutSide::source;
        else if (place[f] > line.high)
            sides[f] = graph::CutSide::sink;
    // Large faces may leave no centre beyond the stretch.
    sides[static_cast<std::size_t>(first - place.begin())] = graph::CutSide::source;
    sides[static_cast<std::size_t>(last - place.begin())] = graph::CutSide::sink;
    graph::MinCut cut(sides);
    for (const HalfEdge h : surface.all_half_edges())
        if (surface.twin[h] > h) {
            const HalfEdge own = surface.mesh_half_edge(h);
            const Vec2& from = uv[own];
            const Vec2& to = uv[Mesh::next(own)];
            // −1 … 1 within the stretch, which rounding leaves empty if it is short and far away.
            const double off =
                line.high > line.low
                    ? (line.along.dot(from + to) - line.low - line.high) / (line.high - line.low)
                    : 0.0;
            cut.link(h / 3, surface.twin[h] / 3,
                     (1.0 + edge_cost * off * off) * (to - from).norm());
        }
    return cut.solve();
}

// Turns all parts of a side over to the other one but its largest: the rest is crumbs between the
// cut and the outline, and arms that no cut of this chart should take off.
void join_crumbs(const atlas::ChartSurface& surface, const CornerUv& uv,
                 std::vector<graph::CutSide>& sides) {
    std::vector<Index> part(sides.size(), -1);
    std::vector<double> area;
    std::vector<Index> stack;
    for (std::size_t start = 0; start < sides.size(); ++start) {
        if (part[start] >= 0)
            continue;
        const Index own = static_cast<Index>(area.size());
        area.push_back(0.0);
        part[start] = own;
        stack.push_back(static_cast<Index>(start));
        while (!stack.empty()) {
            const Face f = stack.back();
            stack.pop_back();
            area.back() += std::abs(plane::uv_area(uv, surface.face[f]));
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = surface.twin[h];
                if (twin < 0 || part[twin / 3] >= 0 || sides[twin / 3] != sides[f])
                    continue;
                part[twin / 3] = own;
                stack.push_back(twin / 3);
            }
        }
    }
    std::array<Index, 2> largest{-1, -1}; // of the source and of the sink
    const auto place = [&](std::size_t f) { return sides[f] == graph::CutSide::source ? 0U : 1U; };
    for (std::size_t f = 0; f < sides.size(); ++f) {
        Index& best = largest[place(f)];
        if (best < 0 || area[part[f]] > area[best])
            best = part[f];
    }
    for (std::size_t f = 0; f < sides.size(); ++f)
        if (part[f] != largest[0] && part[f] != largest[1])
            sides[f] =
                sides[f] == graph::CutSide::source ? graph::CutSide::sink : graph::CutSide::source;
}

void mark_cut(const Mesh& mesh, const atlas::ChartSurface& surface,
              const std::vector<graph::CutSide>& sides, SplitCharts& result,
              std::vector<std::uint8_t>& seam) {
    for (const HalfEdge h : surface.all_half_edges()) {
        const HalfEdge twin = surface.twin[h];
        if (twin < h || sides[h / 3] == sides[twin / 3])
            continue;
        const HalfEdge own = surface.mesh_half_edge(h);
        for (const HalfEdge side : {own, mesh.twin[own]})
            seam[side] = result.cut[side] = 1;
    }
}

} // namespace

SplitCharts split_large_charts(const Mesh& mesh, const CornerUv& uv, const atlas::ChartMap& charts,
                               double longest, Progress& progress) {
    SplitCharts result;
    result.charts = charts;
    result.cut.assign(mesh.twin.size(), 0);
    // Every cut makes two charts of one: this ends.
    for (bool again = true; again;) {
        again = false;
        result.too_large = 0;
        std::vector<std::uint8_t> seam = result.charts.seam;
        for (const atlas::ChartSurface& surface : atlas::extract_charts(mesh, result.charts)) {
            progress.check();
            std::vector<Vec2> points;
            for (const Face f : surface.face)
                for (Index k = 0; k < 3; ++k)
                    points.push_back(uv[3 * f + k]);
            const PieceBox box = least_box(points);
            if (!(box.long_side > longest))
                continue;
            if (surface.face_count() < 2) {
                ++result.too_large;
                continue;
            }
            double start = box.direction.dot(points.front());
            for (const Vec2& p : points)
                start = std::min(start, box.direction.dot(p));
            const CutLine line = choose_line(box, start, longest);
            std::vector<graph::CutSide> sides = sides_of(surface, uv, line);
            join_crumbs(surface, uv, sides);
            mark_cut(mesh, surface, sides, result, seam);
            again = true;
        }
        if (again)
            result.charts = atlas::make_chart_map(mesh, result.charts.chart, seam, true);
    }
    return result;
}

} // namespace devseg::pattern
