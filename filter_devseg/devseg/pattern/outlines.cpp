#include "devseg/pattern/outlines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "devseg/graph/min_cut.h"
#include "devseg/pack/first_fit.h"
#include "devseg/pattern/shapes.h"
#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// Along a layout: parts of split pieces are small there, and half of a cell is lost around each.
constexpr double layout_cells = 1000.0;

// Corners of the texture coordinates along a boundary loop, brought to paper.
PiecePath trace(const atlas::ChartSurface& surface, const std::vector<Index>& loop,
                const CornerUv& uv, const PaperMap& place) {
    PiecePath path;
    for (const HalfEdge h : loop) {
        path.half_edge.push_back(surface.mesh_half_edge(h));
        path.points.push_back(place(uv[path.half_edge.back()]));
    }
    path.area = plane::signed_area(path.points);
    return path;
}

void set_paths(PatternPiece& piece, std::vector<PiecePath> paths) {
    const auto outer =
        std::max_element(paths.begin(), paths.end(),
                         [](const PiecePath& a, const PiecePath& b) { return a.area < b.area; });
    std::swap(*outer, paths.front());
    piece.outer = std::move(paths.front());
    for (std::size_t i = 1; i < paths.size(); ++i) {
        const double length = plane::perimeter(paths[i].points);
        // Less is a cut whose sides coincide, such as the gate makes at edges with three faces:
        // nothing to cut out there.
        if (std::abs(paths[i].area) > vanishing * length * length)
            piece.holes.push_back(std::move(paths[i]));
    }
    measure_outlines(piece);
}

// Pieces that were turned over in their place may stick into their neighbours. Those whose boxes
// keep clear stay.
std::vector<std::size_t> not_clear(const std::vector<PatternPiece>& pieces,
                                   const std::vector<std::size_t>& turned) {
    std::vector<std::size_t> result;
    for (const std::size_t i : turned)
        for (std::size_t j = 0; j < pieces.size(); ++j)
            if (j != i && !pieces[i].box.intersection(pieces[j].box).isEmpty()) {
                result.push_back(i);
                break;
            }
    return result;
}

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

void measure_outlines(PatternPiece& piece) {
    piece.area = 0.0;
    piece.box.setEmpty();
    for (Index l = 0; l < piece.path_count(); ++l) {
        PiecePath& path = piece.path(l);
        path.area = plane::signed_area(path.points);
        piece.area += path.area;
        // Of all loops: in foreign coordinates that fold over, a hole may stick out of the outline.
        for (const Vec2& p : path.points)
            piece.box.extend(p);
    }
}

std::vector<PatternPiece> trace_pieces(const Mesh& mesh, const CornerUv& uv,
                                       const atlas::ChartMap& charts,
                                       const std::vector<double>& uv_areas, double mm_per_uv,
                                       Progress& progress) {
    const std::vector<atlas::ChartSurface> surfaces = atlas::extract_charts(mesh, charts);
    // A layout that is mirrored for the most part is mirrored as a whole, which keeps its pieces
    // apart as they were; what is still mirrored then is turned over in its place.
    const double balance = std::accumulate(uv_areas.begin(), uv_areas.end(), 0.0);
    const double side = balance < 0.0 ? -1.0 : 1.0;
    std::vector<PatternPiece> pieces;
    std::vector<std::size_t> turned;
    for (std::size_t c = 0; c < surfaces.size(); ++c) {
        progress.update(static_cast<double>(c) / static_cast<double>(surfaces.size()));
        if (uv_areas[c] == 0.0 || surfaces[c].loops.empty())
            continue;
        const double mirror = uv_areas[c] < 0.0 ? -1.0 : 1.0;
        PatternPiece piece;
        piece.chart = static_cast<Index>(c);
        piece.place.origin = uv.front();
        piece.place.scale = mm_per_uv * Vec2(mirror, 1.0);
        std::vector<PiecePath> paths;
        for (const std::vector<Index>& loop : surfaces[c].loops)
            paths.push_back(trace(surfaces[c], loop, uv, piece.place));
        set_paths(piece, std::move(paths));
        if (mirror != side) {
            move_piece(piece, Vec2(-2.0 * piece.box.center().x(), 0.0));
            turned.push_back(pieces.size());
        }
        pieces.push_back(std::move(piece));
    }
    move_above(pieces, not_clear(pieces, turned));
    return pieces;
}

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

void move_above(std::vector<PatternPiece>& pieces, std::vector<std::size_t> moved) {
    if (moved.empty())
        return;
    std::stable_sort(moved.begin(), moved.end(), [&](std::size_t a, std::size_t b) {
        return pieces[a].box.sizes().y() > pieces[b].box.sizes().y();
    });
    const Eigen::AlignedBox2d layout = bounding_box(pieces);
    const double gap = gap_share * layout.sizes().maxCoeff();
    const double cell = layout.sizes().maxCoeff() / layout_cells;
    // No wider than the layout, but for half of the gap around each piece.
    const Index columns = static_cast<Index>((layout.sizes().x() + gap) / cell) + 2;
    pack::FreeCells sheet(columns, columns);
    for (const std::size_t i : moved) {
        const std::vector<pack::FitImage> upright{pack::FitImage(
            pack::rasterize(pack::outline_of(pieces[i].rings()), 0.0, cell, 0.5 * gap))};
        pack::Spot spot;
        sheet.put(upright, 0, std::numeric_limits<Index>::max(), spot);
        move_piece(pieces[i], Vec2(layout.min().x() - 0.5 * gap, layout.max().y() + 0.5 * gap) +
                                  pack::placement_of(upright[0].cells, spot, cell).offset);
    }
}

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
