#include "devseg/pattern/outlines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "devseg/pack/first_fit.h"
#include "devseg/plane/box_grid.h"
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

std::vector<Index> PatternPiece::seams() const {
    std::vector<Index> result;
    for (Index i = 0; i < path_count(); ++i)
        for (const OutlineSeam& edge : path(i).edges)
            if (edge.seam >= 0)
                result.push_back(edge.seam);
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
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
    std::vector<Eigen::AlignedBox2d> boxes;
    for (const PatternPiece& piece : pieces)
        boxes.push_back(piece.box);
    std::vector<std::size_t> result;
    plane::BoxGrid clear(boxes);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (clear.any_touching(boxes[i],
                               [&](Index j) { return overlap(pieces[i], pieces[at(j)]); }))
            result.push_back(i);
        else
            clear.add(static_cast<Index>(i));
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

} // namespace devseg::pattern
