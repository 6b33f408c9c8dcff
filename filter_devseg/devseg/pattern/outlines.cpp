#include "devseg/pattern/outlines.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "devseg/pattern/layout.h"
#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// Share of its squared perimeter that a hole must enclose. Less is a cut whose sides coincide,
// such as the gate makes at edges with three faces: nothing to cut out there.
constexpr double no_area = 1e-12;

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
        if (std::abs(paths[i].area) > no_area * length * length)
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
    shelve(pieces, not_clear(pieces, turned));
    return pieces;
}

} // namespace devseg::pattern
