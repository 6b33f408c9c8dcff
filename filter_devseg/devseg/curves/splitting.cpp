#include "devseg/curves/splitting.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "devseg/curves/face_cutting.h"

namespace devseg::curves {

namespace {

struct Tuning {
    double snap = 0.05;        // of an edge: crossings nearer to its ends move there
    double snap_needle = 0.1;  // the same in faces where needles would be, more in each round
    double pin = 0.85;         // barycentric: junctions nearer to a corner move there
    double needle = 2.5;       // degrees: smaller angles are avoided
    double worst_needle = 2.0; // degrees: curves with smaller angles beside them fail
    double apart = 0.12;       // of an edge: distance from others on it beside needles
    double inside = 0.15;      // barycentric: the same of junctions from the edges of a face
    int needle_rounds = 5;
};
constexpr Tuning tuning;

// A piece of a curve, between two points of the finer mesh.
struct Piece {
    Index from;
    Index to;
    Index curve;
    Index label; // of the chart on its left
    bool operator<(const Piece& other) const {
        return std::pair(from, to) < std::pair(other.from, other.to);
    }
};

class Splitter {
public:
    Splitter(Network& network, const atlas::ChartMap& charts)
        : net_(network), mesh_(network.mesh), charts_(charts),
          pinned_(network.crossings.size(), Vertex()) {}

    SplitMesh run() {
        pin_junctions();
        snap_all(tuning.snap);
        for (int round = 0;; ++round) {
            collect_pieces();
            cut_faces();
            if (round == tuning.needle_rounds) {
                fail_needles();
                break;
            }
            mend_needles(tuning.snap_needle * (round + 1));
        }
        SplitMesh result;
        if (failed_.empty())
            finish(result);
        std::sort(failed_.begin(), failed_.end());
        failed_.erase(std::unique(failed_.begin(), failed_.end()), failed_.end());
        result.failed = failed_;
        return result;
    }

private:
    void pin_junctions() {
        for (Index n = 0; n < static_cast<Index>(net_.nodes.size()); ++n)
            for (Index k = 0; k < 3; ++k)
                if (net_.nodes[n].is_junction() && net_.nodes[n].weights[k] > tuning.pin)
                    net_.pin(n, k);
    }

    // All crossings of the curve on the edges of the vertex, one after the other, move there.
    bool snap(Index crossing, bool left) {
        const Vertex w = net_.beside(crossing, left);
        if (net_.occupied[w] != 0 || pinned_[crossing] >= 0)
            return false;
        const auto goes_on = [&](Index c) { return c >= 0 && net_.beside(c, left) == w; };
        Index a = crossing;
        Index b = crossing;
        while (goes_on(net_.crossings[a].previous) && net_.crossings[a].previous != crossing)
            a = net_.crossings[a].previous;
        while (goes_on(net_.crossings[b].next) && net_.crossings[b].next != a)
            b = net_.crossings[b].next;
        // Those that are at another vertex may only be at its ends.
        while (a != b && pinned_[a] >= 0)
            a = net_.crossings[a].next;
        while (a != b && pinned_[b] >= 0)
            b = net_.crossings[b].previous;
        for (Index c = a;; c = net_.crossings[c].next) {
            if (pinned_[c] >= 0 || !net_.is_nearest(c, left))
                return false;
            if (c == b)
                break;
        }
        for (Index c = a;; c = net_.crossings[c].next) {
            pinned_[c] = w;
            if (c == b)
                break;
        }
        net_.occupied[w] = 1;
        return true;
    }

    double to_end(Index c, bool left) const {
        return left ? 1.0 - net_.crossings[c].t : net_.crossings[c].t;
    }

    void snap_listed(std::vector<std::tuple<double, Index, bool>> near) {
        std::sort(near.begin(), near.end());
        for (const auto& place : near)
            snap(std::get<1>(place), std::get<2>(place));
    }

    void snap_all(double nearest) {
        std::vector<std::tuple<double, Index, bool>> near;
        for (Index c = 0; c < static_cast<Index>(net_.crossings.size()); ++c)
            for (const bool left : {true, false})
                if (net_.crossings[c].curve >= 0 && to_end(c, left) < nearest)
                    near.emplace_back(to_end(c, left), c, left);
        snap_listed(std::move(near));
    }

    Index point_of_node(Index node) const {
        const Node& n = net_.nodes[node];
        return n.is_junction() ? first_inside() + node : Index{n.vertex};
    }
    Index point_of_crossing(Index c) const {
        return pinned_[c] >= 0 ? Index{pinned_[c]} : mesh_.vertex_count() + c;
    }

    void add_piece(Index number, Index from, Index to, Face face) {
        if (from == to)
            return;
        const Curve& curve = net_.curves[number];
        const HalfEdge h = curve.path.front();
        pieces_.push_back({from, to, number, charts_.chart[face_of(h)]});
        pieces_.push_back({to, from, number, charts_.chart[mesh_.across(h)]});
        if (face >= 0)
            lines_.emplace_back(face, from, to, number);
    }

    void collect_pieces() {
        pieces_.clear();
        lines_.clear();
        failed_.clear();
        for (Index number = 0; number < static_cast<Index>(net_.curves.size()); ++number) {
            const Curve& curve = net_.curves[number];
            if (curve.held) {
                for (const HalfEdge h : curve.path)
                    add_piece(number, mesh_.origin(h), mesh_.target(h), Face());
                continue;
            }
            const std::size_t before = pieces_.size();
            Index from = curve.is_closed() ? -1 : point_of_node(curve.start);
            for (Index c = curve.first; c >= 0; c = net_.crossings[c].next) {
                const Index to = point_of_crossing(c);
                if (from >= 0)
                    add_piece(number, from, to, face_of(net_.crossings[c].edge));
                from = to;
                if (c == curve.last)
                    break;
            }
            if (curve.is_closed()) {
                if (curve.first < 0)
                    failed_.push_back(number);
                else
                    add_piece(number, from, point_of_crossing(curve.first),
                              face_of(net_.crossings[curve.first].edge));
            } else {
                add_piece(number, from, point_of_node(curve.end), last_face(curve));
            }
            if (curve.start == curve.end && pieces_.size() < before + 6)
                failed_.push_back(number); // a loop without three edges holds nothing
        }
        std::sort(pieces_.begin(), pieces_.end());
        for (std::size_t i = 0; i + 1 < pieces_.size(); ++i)
            if (pieces_[i].from == pieces_[i + 1].from && pieces_[i].to == pieces_[i + 1].to) {
                failed_.push_back(pieces_[i].curve); // two seams in one place
                failed_.push_back(pieces_[i + 1].curve);
            }
        std::sort(lines_.begin(), lines_.end());
    }

    // The face in which the curve ends; none where it is an edge.
    Face last_face(const Curve& curve) const {
        if (curve.last >= 0)
            return mesh_.across(net_.crossings[curve.last].edge);
        for (const Index n : {curve.start, curve.end})
            if (net_.nodes[n].is_junction())
                return net_.nodes[n].face;
        return Face();
    }

    // Faces with lines inside or points on their edges.
    void cut_faces() {
        std::vector<Index> faces;
        for (const auto& line : lines_)
            faces.push_back(std::get<0>(line));
        for (std::size_t c = 0; c < net_.crossings.size(); ++c)
            if (net_.crossings[c].curve >= 0 && pinned_[c] < 0) {
                faces.push_back(face_of(net_.crossings[c].edge));
                faces.push_back(mesh_.across(net_.crossings[c].edge));
            }
        std::sort(faces.begin(), faces.end());
        faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
        splits_.clear();
        angles_.clear();
        unsound_.clear();
        std::size_t line = 0;
        for (const Face f : faces) {
            while (line < lines_.size() && std::get<0>(lines_[line]) < f)
                ++line;
            std::size_t end = line;
            while (end < lines_.size() && std::get<0>(lines_[end]) == f)
                ++end;
            cut(f, line, end);
        }
    }

    void add_point(mesh::SplitFace& split, CutFace& cut, Index point, const Vec3& weights) const {
        const double w = mesh_.edge_length(half_edge_of(split.face, 0));
        const Vec3& a = mesh_.points[mesh_.faces[split.face][0]];
        const Vec3 x = (mesh_.points[mesh_.faces[split.face][1]] - a) / w;
        const Vec3 y = mesh_.face_normals[split.face].cross(x);
        Vec3 place = Vec3::Zero();
        for (Index k = 0; k < 3; ++k)
            place += weights[k] * (mesh_.points[mesh_.faces[split.face][k]] - a);
        cut.points.emplace_back(place.dot(x), place.dot(y));
        split.points.push_back(point);
        split.weights.push_back(weights);
    }

    void cut(Face f, std::size_t first, std::size_t end) {
        mesh::SplitFace split;
        CutFace cut;
        split.face = f;
        for (Index k = 0; k < 3; ++k)
            add_point(split, cut, mesh_.faces[f][k], Vec3::Unit(k));
        for (const HalfEdge h : half_edges_of(f)) {
            cut.ring.push_back(corner_of(h));
            for (const Index c : net_.on_edge(h)) {
                if (pinned_[c] >= 0)
                    continue;
                const double t = net_.position(c, h);
                Vec3 weights = Vec3::Zero();
                weights[corner_of(h)] = 1.0 - t;
                weights[corner_of(Mesh::next(h))] = t;
                cut.ring.push_back(static_cast<Index>(split.points.size()));
                add_point(split, cut, point_of_crossing(c), weights);
            }
        }
        const auto local = [&](Index point) {
            const auto found = std::find(split.points.begin(), split.points.end(), point);
            if (found == split.points.end() && point >= first_inside())
                add_point(split, cut, point, net_.nodes[point - first_inside()].weights);
            else if (found == split.points.end())
                return Index{-1};
            else
                return static_cast<Index>(found - split.points.begin());
            return static_cast<Index>(split.points.size()) - 1;
        };
        bool sound = true;
        for (std::size_t i = first; i < end; ++i) {
            const Index a = local(std::get<1>(lines_[i]));
            const Index b = local(std::get<2>(lines_[i]));
            sound = sound && a >= 0 && b >= 0;
            cut.lines.emplace_back(a, b);
        }
        FaceParts parts;
        if (sound)
            parts = cut_face(cut);
        if (!parts.sound)
            for (const Index c : curves_in(f, first, end))
                unsound_.push_back(c);
        split.parts = std::move(parts.parts);
        if (split.parts.size() > 1) {
            angles_.push_back(parts.smallest_angle);
            splits_.push_back(std::move(split));
        }
    }

    std::vector<Index> curves_in(Face f, std::size_t first, std::size_t end) const {
        std::vector<Index> curves;
        for (std::size_t i = first; i < end; ++i)
            curves.push_back(std::get<3>(lines_[i]));
        for (const HalfEdge h : half_edges_of(f))
            for (const Index c : net_.on_edge(h))
                curves.push_back(net_.crossings[c].curve);
        return curves;
    }

    double old_angle(Face f) const {
        double least = pi;
        for (const HalfEdge h : half_edges_of(f)) {
            const Vec3 a = mesh_.points[mesh_.target(h)] - mesh_.points[mesh_.origin(h)];
            const Vec3 b = mesh_.points[mesh_.apex(h)] - mesh_.points[mesh_.origin(h)];
            least = std::min(least, std::atan2(a.cross(b).norm(), a.dot(b)));
        }
        return least;
    }

    bool is_needle(std::size_t i, double least) const {
        return angles_[i] < std::min(least * degrees, 0.9 * old_angle(splits_[i].face));
    }

    // Where a part of a face is a needle, the curve goes through a vertex instead, or farther from
    // vertices and other curves where it may not.
    void mend_needles(double nearest) {
        std::vector<std::tuple<double, Index, bool>> near;
        std::vector<Index> faces;
        for (std::size_t i = 0; i < splits_.size(); ++i)
            if (is_needle(i, tuning.needle))
                faces.push_back(splits_[i].face);
        for (const Face f : faces)
            for (const HalfEdge h : half_edges_of(f))
                for (const Index c : net_.on_edge(h))
                    for (const bool left : {true, false})
                        if (pinned_[c] < 0 && to_end(c, left) < nearest)
                            near.emplace_back(to_end(c, left), c, left);
        snap_listed(std::move(near));
        for (const Face f : faces)
            for (const HalfEdge h : half_edges_of(f))
                net_.keep_apart(h, tuning.apart);
        for (std::size_t i = 0; i < splits_.size(); ++i)
            for (const Index p : splits_[i].points)
                if (is_needle(i, tuning.needle) && p >= first_inside())
                    net_.keep_inside(p - first_inside(), tuning.inside);
    }

    // Numbers of junctions among points; those of crossings are below.
    Index first_inside() const {
        return mesh_.vertex_count() + static_cast<Index>(net_.crossings.size());
    }

    void fail_needles() {
        for (std::size_t i = 0; i < splits_.size(); ++i)
            if (is_needle(i, tuning.worst_needle))
                for (const HalfEdge h : half_edges_of(splits_[i].face))
                    for (const Index c : net_.on_edge(h))
                        unsound_.push_back(net_.crossings[c].curve);
    }

    void finish(SplitMesh& result) {
        failed_.insert(failed_.end(), unsound_.begin(), unsound_.end());
        if (!failed_.empty())
            return;
        renumber();
        result.refinement = mesh::refine(mesh_, std::move(points_), splits_);
        label(result);
    }

    // New points in the order of their crossings and nodes, without those that are not there.
    void renumber() {
        std::vector<Index> number(net_.crossings.size() + net_.nodes.size(), -1);
        for (mesh::SplitFace& split : splits_)
            for (std::size_t k = 3; k < split.points.size(); ++k) {
                Index& n = number[at(split.points[k] - mesh_.vertex_count())];
                if (n < 0) {
                    n = mesh_.vertex_count() + static_cast<Index>(points_.size());
                    points_.push_back({split.face, split.weights[k]});
                }
                split.points[k] = n;
            }
        const auto renumbered = [&](Index point) {
            return point < mesh_.vertex_count() ? point : number[at(point - mesh_.vertex_count())];
        };
        for (Piece& piece : pieces_) {
            piece.from = renumbered(piece.from);
            piece.to = renumbered(piece.to);
        }
        std::sort(pieces_.begin(), pieces_.end());
    }

    const Piece* piece_at(Index from, Index to) const {
        const Piece wanted{from, to, -1, -1};
        const auto found = std::lower_bound(pieces_.begin(), pieces_.end(), wanted);
        return found != pieces_.end() && !(wanted < *found) ? &*found : nullptr;
    }

    // Labels spread from the two sides of the curves.
    void label(SplitMesh& result) {
        const Mesh& fine = result.refinement.mesh;
        atlas::ChartMap& charts = result.charts;
        charts.count = charts_.count;
        charts.chart.assign(fine.faces.size(), -1);
        charts.seam.assign(fine.twin.size(), 0);
        std::vector<std::uint8_t> on_curve(fine.points.size(), 0);
        for (const Piece& piece : pieces_)
            on_curve[piece.from] = 1;
        std::vector<Face> stack;
        std::size_t found = 0;
        for (const HalfEdge h : fine.all_half_edges()) {
            if (on_curve[fine.origin(h)] == 0 || on_curve[fine.target(h)] == 0)
                continue;
            const Piece* piece = piece_at(fine.origin(h), fine.target(h));
            if (piece == nullptr)
                continue;
            ++found;
            charts.seam[h] = 1;
            const Face f = face_of(h);
            if (charts.chart[f] >= 0 && charts.chart[f] != piece->label)
                failed_.push_back(piece->curve);
            charts.chart[f] = piece->label;
            stack.push_back(f);
        }
        if (found != pieces_.size()) // a piece that is no edge
            for (const Piece& piece : pieces_)
                failed_.push_back(piece.curve);
        spread(fine, charts, stack);
        for (const Face f : fine.all_faces()) // without seams: as they were
            if (charts.chart[f] < 0)
                charts.chart[f] = charts_.chart[f];
        check_parts(fine, charts);
    }

    // Every chart hangs together.
    void check_parts(const Mesh& fine, const atlas::ChartMap& charts) {
        const mesh::FaceComponents parts =
            mesh::face_components(fine, [&](HalfEdge h) { return charts.seam[h] == 0; });
        std::vector<Index> part_of(at(charts.count), -1);
        std::vector<std::uint8_t> torn(at(charts.count), 0);
        for (const Face f : fine.all_faces()) {
            Index& part = part_of[charts.chart[f]];
            if (part >= 0 && part != parts.label[f])
                torn[charts.chart[f]] = 1;
            part = parts.label[f];
        }
        for (const Piece& piece : pieces_)
            if (torn[piece.label] != 0 || part_of[piece.label] < 0)
                failed_.push_back(piece.curve);
    }

    void spread(const Mesh& fine, atlas::ChartMap& charts, std::vector<Face>& stack) {
        while (!stack.empty()) {
            const Face f = stack.back();
            stack.pop_back();
            for (const HalfEdge h : half_edges_of(f)) {
                const Face g = fine.across(h);
                if (g < 0 || charts.seam[h] != 0)
                    continue;
                if (charts.chart[g] < 0) {
                    charts.chart[g] = charts.chart[f];
                    stack.push_back(g);
                } else if (charts.chart[g] != charts.chart[f]) {
                    for (const Piece& piece : pieces_)
                        if (piece.label == charts.chart[g] || piece.label == charts.chart[f])
                            failed_.push_back(piece.curve);
                }
            }
        }
    }

    Network& net_;
    const Mesh& mesh_;
    const atlas::ChartMap& charts_;
    std::vector<Vertex> pinned_; // of each crossing: the vertex it has moved to
    std::vector<Piece> pieces_;  // of all curves, both ways
    std::vector<std::tuple<Index, Index, Index, Index>> lines_; // face, from, to, curve
    std::vector<mesh::SplitFace> splits_;
    std::vector<double> angles_; // of each split face: its smallest, radians
    std::vector<mesh::Refinement::Point> points_;
    std::vector<Index> failed_;
    std::vector<Index> unsound_; // curves in faces that could not be cut
};

} // namespace

SplitMesh split_along(Network& network, const atlas::ChartMap& charts) {
    return Splitter(network, charts).run();
}

} // namespace devseg::curves
