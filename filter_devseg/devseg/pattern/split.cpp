#include "devseg/pattern/split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>

#include "devseg/atlas/border_path.h"
#include "devseg/base/errors.h"
#include "devseg/graph/min_cut.h"
#include "devseg/pattern/shapes.h"
#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// More cuts than anybody sews or glues: the limit is a slip of the pen.
constexpr double most_cuts = 1000.0;

// Lengths that differ by this share are equal: limits are often the exact size of a part.
constexpr double same_length = 1e-6;

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
std::vector<graph::CutSide> sides_of(const Mesh& mesh, const atlas::ChartSurface& surface,
                                     const CornerUv& uv, const CutLine& line) {
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
            const double length = mesh.edge_length(own);
            const double through_flat = length > 0.0 ? atlas::cut_cost(mesh, own) / length : 1.0;
            cut.link(h / 3, surface.twin[h] / 3,
                     (1.0 + edge_cost * off * off) * through_flat * (to - from).norm());
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

void mark_cut(const atlas::ChartSurface& surface, const std::vector<graph::CutSide>& sides,
              SplitLayout& layout) {
    for (const HalfEdge h : surface.all_half_edges()) {
        const HalfEdge twin = surface.twin[h];
        if (twin < h || sides[face_of(h)] == sides[face_of(twin)])
            continue;
        const HalfEdge own = surface.mesh_half_edge(h);
        for (const HalfEdge side : {own, layout.mesh.twin[own]})
            layout.charts.seam[side] = layout.cut[side] = 1;
    }
}

double parts_of(double length, double longest) {
    return std::max(1.0, std::ceil(length / longest - same_length));
}

// Whether the cut leaves parts that need no more cuts across the line than they should.
bool is_short_enough(const atlas::ChartSurface& surface, const CornerUv& uv,
                     const std::vector<graph::CutSide>& sides, const PieceBox& box,
                     double longest) {
    double parts = 0.0;
    for (const graph::CutSide side : {graph::CutSide::source, graph::CutSide::sink}) {
        double low = infinite;
        double high = -infinite;
        for (const Face f : surface.all_faces())
            if (sides[f] == side)
                for (const HalfEdge h : half_edges_of(surface.face[f])) {
                    low = std::min(low, box.direction.dot(uv[h]));
                    high = std::max(high, box.direction.dot(uv[h]));
                }
        parts += parts_of(high - low, longest);
    }
    return parts <= parts_of(box.long_side, longest);
}

PieceBox box_of(const atlas::ChartSurface& surface, const CornerUv& uv, double& start) {
    std::vector<Vec2> points;
    for (const Face f : surface.face)
        for (const HalfEdge h : half_edges_of(f))
            points.push_back(uv[h]);
    const PieceBox box = least_box(points);
    start = infinite;
    for (const Vec2& p : points)
        start = std::min(start, box.direction.dot(p));
    return box;
}

// A straight cut through the faces of a chart.
struct Slice {
    Index chart = -1;
    Vec2 along = Vec2::UnitX(); // unit, across the cut
    double place = 0.0;         // of the cut along it
    double rounding = 0.0;      // vertices nearer to the cut lie on it
};

class Slicer {
public:
    Slicer(const Slice& slice, SplitLayout& layout) : slice_(slice), layout_(layout) {}

    void run() {
        std::vector<Face> faces;
        for (const Face f : layout_.mesh.all_faces())
            if (layout_.charts.chart[f] == slice_.chart)
                faces.push_back(f);
        for (std::size_t i = 0; i < faces.size(); ++i)
            for (Index k = 0; k < 3;) {
                const HalfEdge h = half_edge_of(faces[i], k);
                const double from = distance(layout_.uv[h]);
                const double to = distance(layout_.uv[Mesh::next(h)]);
                if (std::min(from, to) >= -slice_.rounding ||
                    std::max(from, to) <= slice_.rounding) {
                    ++k;
                    continue;
                }
                const Face before = layout_.mesh.face_count();
                split_edge(h, from / (from - to));
                for (Face f = before; f < layout_.mesh.face_count(); ++f)
                    if (layout_.charts.chart[f] == slice_.chart)
                        faces.push_back(f);
                k = 0;
            }
        mark(faces);
    }

private:
    const Slice& slice_;
    SplitLayout& layout_;

    double distance(const Vec2& p) const { return slice_.along.dot(p) - slice_.place; }

    double side(Face f) const {
        const CornerUv& uv = layout_.uv;
        return distance((uv[3 * f] + uv[3 * f + 1] + uv[3 * f + 2]) / 3.0);
    }

    void mark(const std::vector<Face>& faces) {
        for (const Face f : faces)
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge twin = layout_.mesh.twin[h];
                if (twin < 0 || layout_.charts.seam[h] != 0 ||
                    (side(f) < 0.0) == (side(face_of(twin)) < 0.0))
                    continue;
                for (const HalfEdge one : {h, twin})
                    layout_.charts.seam[one] = layout_.cut[one] = 1;
            }
    }

    // A vertex at this share of the edge; both faces become two.
    void split_edge(HalfEdge h, double share) {
        Mesh& mesh = layout_.mesh;
        const HalfEdge twin = mesh.twin[h];
        const Vec3 p =
            (1.0 - share) * mesh.points[mesh.origin(h)] + share * mesh.points[mesh.target(h)];
        const Vertex middle = mesh.vertex_count();
        mesh.points.push_back(p);
        const HalfEdge second = split_face(h, middle, share);
        if (twin < 0)
            return;
        const HalfEdge other = split_face(twin, middle, 1.0 - share);
        pair(h, other);
        pair(twin, second);
    }

    // Face (a, b, c) with h = (a, b) becomes (a, m, c), and a new face (m, b, c) at the end.
    // Returns the half-edge (m, b).
    HalfEdge split_face(HalfEdge h, Vertex middle, double share) {
        Mesh& mesh = layout_.mesh;
        const HalfEdge after = Mesh::next(h); // (b, c), later (m, c)
        const HalfEdge last = Mesh::previous(h);
        const Face f = face_of(h);
        const HalfEdge fresh = mesh.half_edge_count();
        CornerUv& uv = layout_.uv;
        const Vec2 place = (1.0 - share) * uv[h] + share * uv[after];
        mesh.faces.push_back({middle, mesh.target(h), mesh.apex(h)});
        uv.insert(uv.end(), {place, uv[after], uv[last]});
        mesh.faces[f][corner_of(after)] = middle;
        uv[after] = place;
        layout_.source_face.push_back(layout_.source_face[f]);
        layout_.charts.chart.push_back(layout_.charts.chart[f]);
        for (std::vector<std::uint8_t>* marks : {&layout_.charts.seam, &layout_.cut}) {
            const std::uint8_t of_first = (*marks)[h];
            const std::uint8_t of_second = (*marks)[after];
            marks->insert(marks->end(), {of_first, of_second, 0});
            (*marks)[after] = 0;
        }
        const HalfEdge beside = mesh.twin[after];
        mesh.twin.resize(mesh.twin.size() + 3);
        if (beside >= 0)
            pair(fresh + 1, beside);
        pair(after, fresh + 2);
        return fresh;
    }

    void pair(HalfEdge a, HalfEdge b) {
        layout_.mesh.twin[a] = b;
        layout_.mesh.twin[b] = a;
    }
};

// How long a part with this box may be: where it is too wide, it is cut until it is short enough to
// lie across.
double allowed_length(const PieceBox& box, const PieceLimit& limit) {
    return parts_of(box.short_side, limit.widest) > 1.0 ? limit.widest : limit.longest;
}

void refuse_too_many(const SplitLayout& layout, const PieceLimit& limit) {
    double cuts = 0.0;
    for (const atlas::ChartSurface& surface : atlas::extract_charts(layout.mesh, layout.charts)) {
        double start = 0.0;
        const PieceBox box = box_of(surface, layout.uv, start);
        const double longest = allowed_length(box, limit);
        cuts += parts_of(box.long_side, longest) * parts_of(box.short_side, longest) - 1.0;
    }
    if (cuts > most_cuts)
        throw InvalidParameter("max_piece_mm: expected a limit that takes at most " +
                               std::to_string(static_cast<int>(most_cuts)) +
                               " cuts, found one that takes about " +
                               std::to_string(static_cast<long long>(std::min(cuts, 1e15))) +
                               "; give a larger one, or a smaller scale");
}

} // namespace

SplitLayout whole_layout(const Mesh& mesh, const CornerUv& uv, const atlas::ChartMap& charts) {
    SplitLayout layout{mesh, uv, {}, charts, std::vector<std::uint8_t>(mesh.twin.size(), 0)};
    layout.source_face.resize(mesh.faces.size());
    std::iota(layout.source_face.begin(), layout.source_face.end(), 0);
    return layout;
}

void split_large_charts(const PieceLimit& limit, SplitLayout& layout, const Progress& progress) {
    refuse_too_many(layout, limit);
    // Every cut makes parts that are shorter across it: this ends.
    for (bool again = true; again;) {
        again = false;
        std::vector<Slice> slices;
        const atlas::ChartMap charts = layout.charts;
        const std::vector<atlas::ChartSurface> surfaces =
            atlas::extract_charts(layout.mesh, charts);
        for (Index c = 0; c < charts.count; ++c) {
            progress.check();
            const atlas::ChartSurface& surface = surfaces[c];
            double start = 0.0;
            const PieceBox box = box_of(surface, layout.uv, start);
            const double longest = allowed_length(box, limit);
            if (parts_of(box.long_side, longest) == 1.0)
                continue;
            again = true;
            const CutLine line = choose_line(box, start, longest);
            if (surface.face_count() > 1) {
                std::vector<graph::CutSide> sides = sides_of(layout.mesh, surface, layout.uv, line);
                join_crumbs(surface, layout.uv, sides);
                if (is_short_enough(surface, layout.uv, sides, box, longest)) {
                    mark_cut(surface, sides, layout);
                    continue;
                }
            }
            slices.push_back({c, line.along, 0.5 * (line.low + line.high), same_length * longest});
        }
        for (const Slice& slice : slices)
            Slicer(slice, layout).run();
        if (!slices.empty())
            mesh::compute_face_geometry(layout.mesh);
        if (again)
            layout.charts =
                atlas::make_chart_map(layout.mesh, layout.charts.chart, layout.charts.seam, true);
    }
}

} // namespace devseg::pattern
