#include "devseg/pattern/split.h"

#include <algorithm>
#include <cmath>

#include "devseg/cut/min_cut.h"
#include "devseg/pattern/shapes.h"

namespace devseg {

namespace {

// A cut at the edge of the stretch costs so much more than one of the same length in its middle:
// it leaves parts that are as large as allowed, and no play for further cuts.
constexpr double edge_cost = 0.5;

// The cut may move by this share of the allowed length at least, to find a short way.
constexpr double least_play = 0.1;

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
    const double half = std::max(0.5 * (high - low), 0.5 * least_play * longest);
    return {box.direction, start + middle - half, start + middle + half};
}

// Which faces of the chart lie before the shortest cut near the line.
std::vector<CutSide> sides_of(const ChartSurface& surface, const CornerUv& uv,
                              const CutLine& line) {
    std::vector<double> place;
    for (const Index f : surface.face)
        place.push_back(line.along.dot(uv[at(3 * f)] + uv[at(3 * f + 1)] + uv[at(3 * f + 2)]) /
                        3.0);
    const auto [first, last] = std::minmax_element(place.begin(), place.end());
    std::vector<CutSide> sides(place.size(), CutSide::open);
    for (std::size_t f = 0; f < place.size(); ++f)
        if (place[f] < line.low)
            sides[f] = CutSide::source;
        else if (place[f] > line.high)
            sides[f] = CutSide::sink;
    // Large faces may leave no centre beyond the stretch.
    sides[static_cast<std::size_t>(first - place.begin())] = CutSide::source;
    sides[static_cast<std::size_t>(last - place.begin())] = CutSide::sink;
    MinCut cut(sides);
    for (Index h = 0; h < 3 * surface.face_count(); ++h)
        if (surface.twin[at(h)] > h) {
            const Index own = surface.mesh_half_edge(h);
            const Vec2& from = uv[at(own)];
            const Vec2& to = uv[at(Mesh::next(own))];
            const double off = (line.along.dot(from + to) - line.low - line.high) /
                               (line.high - line.low); // −1 … 1 within the stretch
            cut.link(h / 3, surface.twin[at(h)] / 3,
                     (1.0 + edge_cost * off * off) * (to - from).norm());
        }
    return cut.solve();
}

void mark_cut(const Mesh& mesh, const ChartSurface& surface, const std::vector<CutSide>& sides,
              SplitCharts& result, std::vector<std::uint8_t>& seam) {
    for (Index h = 0; h < 3 * surface.face_count(); ++h) {
        const Index twin = surface.twin[at(h)];
        if (twin < h || sides[at(h / 3)] == sides[at(twin / 3)])
            continue;
        const Index own = surface.mesh_half_edge(h);
        for (const Index side : {own, mesh.twin[at(own)]})
            seam[at(side)] = result.cut[at(side)] = 1;
    }
}

} // namespace

SplitCharts split_large_charts(const Mesh& mesh, const CornerUv& uv, const ChartMap& charts,
                               double longest, Progress& progress) {
    SplitCharts result;
    result.charts = charts;
    result.cut.assign(mesh.twin.size(), 0);
    // Every cut makes two charts of one: this ends.
    for (bool again = true; again;) {
        again = false;
        result.too_large = 0;
        std::vector<std::uint8_t> seam = result.charts.seam;
        for (const ChartSurface& surface : extract_charts(mesh, result.charts)) {
            progress.check();
            std::vector<Vec2> points;
            for (const Index f : surface.face)
                for (Index k = 0; k < 3; ++k)
                    points.push_back(uv[at(3 * f + k)]);
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
            mark_cut(mesh, surface, sides_of(surface, uv, line), result, seam);
            again = true;
        }
        if (again)
            result.charts = make_chart_map(mesh, result.charts.chart, seam, true);
    }
    return result;
}

} // namespace devseg
