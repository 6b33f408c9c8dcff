#include "devseg/curves/splitting.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "devseg/curves/face_cutting.h"
#include "devseg/curves/side_labels.h"

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
    double longer = 1.02; // of its length: a curve that grows by more fails
};
constexpr Tuning tuning;

class Splitter {
public:
    Splitter(Network& network, const atlas::ChartMap& charts, const Progress& progress)
        : net_(network), mesh_(network.mesh), charts_(charts), progress_(progress),
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
        for (const Index c : failed_)
            result.failed.push_back({c, -1});
        result.failed.insert(result.failed.end(), unsound_.begin(), unsound_.end());
        std::sort(result.failed.begin(), result.failed.end());
        result.failed.erase(std::unique(result.failed.begin(), result.failed.end()),
                            result.failed.end());
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
        Heartbeat beat(progress_);
        for (const Face f : faces) {
            beat();
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
                unsound_.push_back({c, f});
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
                        unsound_.push_back({net_.crossings[c].curve, splits_[i].face});
    }

    void finish(SplitMesh& result) {
        if (!unsound_.empty())
            return;
        renumber();
        result.refinement = mesh::refine(mesh_, std::move(points_), splits_);
        result.charts = label_sides(result.refinement, charts_, pieces_, sides(), failed_);
        fail_longer(result.refinement.mesh);
    }

    std::vector<Sides> sides() const {
        std::vector<Sides> sides;
        for (Index number = 0; number < static_cast<Index>(net_.curves.size()); ++number)
            for (const HalfEdge h : net_.curves[number].path)
                sides.push_back(
                    {charts_.chart[face_of(h)], charts_.chart[mesh_.across(h)], number});
        return sides;
    }

    // A curve that had to go a longer way is no gain.
    void fail_longer(const Mesh& fine) {
        std::vector<double> longer(net_.curves.size(), 0.0);
        for (const Piece& piece : pieces_)
            longer[piece.curve] += 0.5 * (fine.points[piece.from] - fine.points[piece.to]).norm();
        for (std::size_t c = 0; c < longer.size(); ++c) {
            double before = 0.0;
            for (const HalfEdge h : net_.curves[c].path)
                before += mesh_.edge_length(h);
            if (!net_.curves[c].held && longer[c] > tuning.longer * before)
                failed_.push_back(static_cast<Index>(c));
        }
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

    Network& net_;
    const Mesh& mesh_;
    const atlas::ChartMap& charts_;
    const Progress& progress_;
    std::vector<Vertex> pinned_; // of each crossing: the vertex it has moved to
    std::vector<Piece> pieces_;  // of all curves, both ways
    std::vector<std::tuple<Index, Index, Index, Index>> lines_; // face, from, to, curve
    std::vector<mesh::SplitFace> splits_;
    std::vector<double> angles_; // of each split face: its smallest, radians
    std::vector<mesh::Refinement::Point> points_;
    std::vector<Index> failed_;
    std::vector<Failure> unsound_; // curves in faces that could not be cut
};

} // namespace

SplitMesh split_along(Network& network, const atlas::ChartMap& charts, const Progress& progress) {
    return Splitter(network, charts, progress).run();
}

} // namespace devseg::curves
