#include "devseg/curves/network.h"

#include <algorithm>

namespace devseg::curves {

namespace {

struct Tuning {
    double beside_vertex = 0.02; // of an edge: where curves arrive that have just passed its end
};
constexpr Tuning tuning;

} // namespace

// A curve that leaves a junction through its face.
struct Network::Spoke {
    Index curve;
    bool start;      // the curve's start is at the junction
    Index crossing;  // the first from there, −1 where the curve ends in the same face
    bool on_edge;    // that crossing is on the edge e
    double position; // else where it leaves: 0 at the target of e, 1 at the apex, 2 at the origin
};

std::vector<Index> Network::on_edge(HalfEdge h) const {
    const HalfEdge lower = std::min<Index>(h, mesh.twin[h]);
    std::vector<Index> list;
    if (lower < 0)
        return list;
    for (Index c = lowest_[lower]; c >= 0; c = crossings[c].above)
        list.push_back(c);
    if (h != lower)
        std::reverse(list.begin(), list.end());
    return list;
}

bool Network::is_nearest(Index crossing, bool left) const {
    const Crossing& c = crossings[crossing];
    const bool towards_target = left; // of c.edge
    const bool is_lower = c.edge < mesh.twin[c.edge];
    return (towards_target == is_lower ? c.above : c.below) < 0;
}

void Network::link_on_edge(Index crossing) {
    Crossing& c = crossings[crossing];
    const HalfEdge lower = std::min<Index>(c.edge, mesh.twin[c.edge]);
    const double p = position(crossing, lower);
    Index before = -1;
    Index behind = lowest_[lower];
    while (behind >= 0 && position(behind, lower) < p) {
        before = behind;
        behind = crossings[behind].above;
    }
    c.below = before;
    c.above = behind;
    (before >= 0 ? crossings[before].above : lowest_[lower]) = crossing;
    if (behind >= 0)
        crossings[behind].below = crossing;
}

void Network::unlink_on_edge(Index crossing) {
    const Crossing& c = crossings[crossing];
    const HalfEdge lower = std::min<Index>(c.edge, mesh.twin[c.edge]);
    (c.below >= 0 ? crossings[c.below].above : lowest_[lower]) = c.above;
    if (c.above >= 0)
        crossings[c.above].below = c.below;
}

Index Network::insert(HalfEdge edge, double t, Index curve, Index previous, Index next) {
    const auto c = static_cast<Index>(crossings.size());
    crossings.push_back({edge, t, curve, previous, next, -1, -1});
    (previous >= 0 ? crossings[previous].next : curves[curve].first) = c;
    (next >= 0 ? crossings[next].previous : curves[curve].last) = c;
    link_on_edge(c);
    return c;
}

void Network::remove(Index crossing) {
    unlink_on_edge(crossing);
    const Crossing c = crossings[crossing];
    Curve& curve = curves[c.curve];
    if (curve.first == crossing)
        curve.first = c.next;
    if (curve.last == crossing)
        curve.last = c.previous;
    if (c.previous >= 0)
        crossings[c.previous].next = c.next;
    if (c.next >= 0)
        crossings[c.next].previous = c.previous;
    crossings[crossing].curve = -1;
}

// The curve comes back over the edge that it has just crossed, with nothing in between.
bool Network::is_undone(Index crossing) const {
    const Crossing& c = crossings[crossing];
    if (c.next < 0 || c.next == crossing || crossings[c.next].next == crossing)
        return false;
    return crossings[c.next].edge == mesh.twin[c.edge] && (c.above == c.next || c.below == c.next);
}

void Network::reduce_from(Index crossing) {
    while (crossing >= 0 && is_undone(crossing)) {
        const Index before = crossings[crossing].previous;
        remove(crossings[crossing].next);
        remove(crossing);
        crossing = before;
    }
}

// A curve that starts at a vertex and crosses one of its edges turns around the vertex instead.
void Network::drop_spurs(Curve& curve) {
    for (const bool start : {true, false}) {
        const Index node = start ? curve.start : curve.end;
        if (node < 0 || nodes[node].is_junction())
            continue;
        for (;;) {
            const Index c = from_end(curve, start);
            if (c < 0)
                break;
            const bool left = beside(c, true) == nodes[node].vertex;
            if ((!left && beside(c, false) != nodes[node].vertex) || !is_nearest(c, left))
                break;
            remove(c);
        }
    }
}

bool Network::pass(Index first, Index last, bool left) {
    const Vertex w = beside(first, left);
    const Index curve = crossings[first].curve;
    if (occupied[w] != 0)
        return false;
    for (Index c = first;; c = crossings[c].next) {
        if (!is_nearest(c, left))
            return false;
        if (c == last)
            break;
    }
    const Index before = crossings[first].previous;
    const Index behind = crossings[last].next;
    if (before == last) // a closed curve around the vertex
        return false;
    if (before < 0 && behind < 0 && curves[curve].start == curves[curve].end) // a loop, the same
        return false;
    const auto corner = [&](Index node) { return node < 0 ? Vertex() : nodes[node].vertex; };
    const Vertex start = before < 0 ? corner(curves[curve].start) : Vertex();
    const Vertex end = behind < 0 ? corner(curves[curve].end) : Vertex();

    std::vector<HalfEdge> around; // the other edges of the vertex, each left from the curve's side
    const Face goal = mesh.across(crossings[last].edge);
    const HalfEdge e = crossings[first].edge;
    HalfEdge g = left ? Mesh::next(e) : Mesh::previous(e);
    for (Face f = face_of(e); f != goal; f = face_of(mesh.twin[around.back()])) {
        around.push_back(g);
        g = left ? Mesh::next(mesh.twin[g]) : Mesh::previous(mesh.twin[g]);
    }
    const auto far_end = [&](HalfEdge h) { return left ? mesh.target(h) : mesh.origin(h); };
    if (start >= 0 && !around.empty() && far_end(around.front()) == start)
        around.erase(around.begin());
    if (end >= 0 && !around.empty() && far_end(around.back()) == end)
        around.pop_back();

    for (Index c = first; c != behind && c >= 0;) {
        const Index following = crossings[c].next;
        remove(c);
        c = c == last ? -1 : following;
    }
    Index at_end = before;
    for (const HalfEdge h : around) {
        // Nearer to the vertex than whatever else is on the edge.
        const std::vector<Index> others = on_edge(h);
        double t = tuning.beside_vertex;
        if (!others.empty())
            t = left ? std::min(t, 0.5 * position(others.front(), h))
                     : std::min(t, 0.5 * (1.0 - position(others.back(), h)));
        at_end = insert(h, left ? t : 1.0 - t, curve, at_end, behind);
    }
    if (before >= 0)
        reduce_from(before);
    drop_spurs(curves[curve]);
    return true;
}

void Network::keep_apart(HalfEdge h, double gap) {
    const std::vector<Index> list = on_edge(h);
    gap = std::min(gap, 0.5 / static_cast<double>(list.size() + 1));
    std::vector<double> p;
    double least = 0.0;
    for (const Index c : list) {
        p.push_back(std::max(position(c, h), least + gap));
        least = p.back();
    }
    double most = 1.0;
    for (std::size_t i = list.size(); i-- > 0;) {
        p[i] = most = std::min(p[i], most - gap);
        Crossing& c = crossings[list[i]];
        c.t = c.edge == h ? p[i] : 1.0 - p[i];
    }
}

// Where the chord of a crossing on the half-edge h ends in the face of h: 0 at the target of e,
// 1 at the apex, 2 at its origin, 2 to 3 on e. None where it ends at a junction.
std::optional<double> Network::chord_end(HalfEdge e, HalfEdge h, Index crossing) const {
    const bool forwards = crossings[crossing].edge != h; // the curve enters the face here
    const Index other = after(crossing, forwards);
    if (other < 0) {
        const Curve& curve = curves[crossings[crossing].curve];
        const Node& node = nodes[forwards ? curve.end : curve.start];
        if (node.is_junction())
            return {};
        return node.vertex == mesh.target(e) ? 0.0 : node.vertex == mesh.origin(e) ? 2.0 : 1.0;
    }
    const HalfEdge g = leaving(other, forwards);
    const double base = g == e ? 2.0 : g == Mesh::next(e) ? 0.0 : 1.0;
    return base + position(other, g);
}

std::vector<Network::Spoke> Network::spokes_of(Index node, HalfEdge e) const {
    std::vector<Spoke> spokes;
    std::vector<Index> own = nodes[node].curves;
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    for (const Index i : own)
        for (const bool start : {true, false}) {
            const Curve& curve = curves[i];
            if ((start ? curve.start : curve.end) != node)
                continue;
            Spoke spoke{i, start, from_end(curve, start), false, 1.0};
            if (spoke.crossing < 0) {
                const Vertex v = nodes[start ? curve.end : curve.start].vertex;
                spoke.position = v == mesh.target(e) ? 0.0 : v == mesh.origin(e) ? 2.0 : 1.0;
            } else {
                const HalfEdge g = leaving(spoke.crossing, start);
                spoke.on_edge = g == e;
                spoke.position = (g == e               ? 2.0
                                  : g == Mesh::next(e) ? 0.0
                                                       : 1.0) +
                                 position(spoke.crossing, g);
            }
            spokes.push_back(spoke);
        }
    return spokes;
}

// Another curve passes between the junction and the edge e.
bool Network::is_walled_off(HalfEdge e, const std::vector<Spoke>& spokes) const {
    for (const HalfEdge h : {Mesh::next(e), Mesh::previous(e)})
        for (const Index c : on_edge(h)) {
            const std::optional<double> end = chord_end(e, h, c);
            const double start = (h == Mesh::next(e) ? 0.0 : 1.0) + position(c, h);
            if (!end || (*end > 2.0))
                continue;
            for (const Spoke& s : spokes)
                if (!s.on_edge && s.position > std::min(start, *end) &&
                    s.position < std::max(start, *end))
                    return true;
        }
    return false;
}

// Between which positions on e the junction can pass; the first is larger where nowhere.
std::pair<double, double> Network::gap_on(HalfEdge e, const std::vector<Spoke>& spokes) const {
    const std::pair<double, double> nowhere{1.0, 0.0};
    const auto is_spoke = [&](Index c) {
        return std::any_of(spokes.begin(), spokes.end(),
                           [&](const Spoke& s) { return s.on_edge && s.crossing == c; });
    };
    const bool through =
        std::any_of(spokes.begin(), spokes.end(), [](const Spoke& s) { return s.on_edge; });
    std::pair<double, double> gap{0.0, 1.0};
    bool seen = false;
    for (const Index c : on_edge(e)) {
        const double p = position(c, e);
        if (is_spoke(c)) {
            seen = true;
            continue;
        }
        bool below = !seen;
        if (!through) {
            const std::optional<double> end = chord_end(e, e, c);
            const auto other = std::find_if(spokes.begin(), spokes.end(), [&](const Spoke& s) {
                return end && s.position != *end;
            });
            if (other == spokes.end())
                return nowhere;
            below = *end > other->position;
        }
        if (below)
            gap.first = std::max(gap.first, p);
        else
            gap.second = std::min(gap.second, p);
    }
    return gap;
}

bool Network::push(Index node, HalfEdge e, double t) {
    Node& junction = nodes[node];
    const Face to = mesh.across(e);
    if (to < 0 || junctions_in_[junction.face] > 1 || junctions_in_[to] > 0)
        return false;
    std::vector<Spoke> spokes = spokes_of(node, e);
    for (const Spoke& s : spokes)
        if (s.crossing < 0 &&
            nodes[s.start ? curves[s.curve].end : curves[s.curve].start].is_junction())
            return false;
    const auto [low, high] = gap_on(e, spokes);
    if (low >= high || is_walled_off(e, spokes))
        return false;
    std::stable_sort(spokes.begin(), spokes.end(), [](const Spoke& a, const Spoke& b) {
        return a.position > b.position; // from the origin of e to its target
    });
    std::vector<Spoke> through;
    for (const Spoke& s : spokes) {
        if (s.on_edge)
            remove(s.crossing);
        else if (s.crossing >= 0 || s.position == 1.0)
            through.push_back(s);
    }
    const double middle = std::clamp(t, low + 0.25 * (high - low), high - 0.25 * (high - low));
    const double width = 0.25 * (high - low);
    double share = 0.0;
    for (const Spoke& s : through) {
        share += 1.0 / static_cast<double>(through.size() + 1);
        const double p = middle + width * (2.0 * share - 1.0);
        if (s.start)
            insert(mesh.twin[e], 1.0 - p, s.curve, -1, curves[s.curve].first);
        else
            insert(e, p, s.curve, curves[s.curve].last, -1);
    }
    --junctions_in_[junction.face];
    ++junctions_in_[to];
    junction.face = to;
    for (const Spoke& s : spokes)
        drop_spurs(curves[s.curve]);
    return true;
}

bool Network::pin(Index node, Index corner) {
    Node& junction = nodes[node];
    const Vertex w = mesh.faces[junction.face][corner];
    const HalfEdge opposite = Mesh::next(half_edge_of(junction.face, corner));
    if (occupied[w] != 0 || junctions_in_[junction.face] > 1)
        return false;
    const std::vector<Spoke> spokes = spokes_of(node, opposite);
    for (const Index c : on_edge(Mesh::next(opposite))) {
        const std::optional<double> end = chord_end(opposite, Mesh::next(opposite), c);
        if (end && *end > 1.0 && *end <= 2.0) // a curve around the corner; is the junction inside?
            for (const Spoke& s : spokes)
                if (s.on_edge || s.position < position(c, Mesh::next(opposite)) ||
                    s.position > *end)
                    return false;
    }
    for (const Spoke& s : spokes) {
        const Curve& curve = curves[s.curve];
        if (curve.start == curve.end)
            return false;
    }
    junction.vertex = w;
    occupied[w] = 1;
    --junctions_in_[junction.face];
    for (const Spoke& s : spokes)
        drop_spurs(curves[s.curve]);
    return true;
}

void Network::keep_inside(Index node, double margin) {
    Node& junction = nodes[node];
    const HalfEdge e = half_edge_of(junction.face, 0);
    // Positions as chord_end counts them, in barycentric coordinates (all that matters is affine).
    const auto place = [](double position) {
        const double t = position < 1.0   ? position
                         : position < 2.0 ? position - 1.0
                                          : position - 2.0;
        const Vec3 from = position < 1.0   ? Vec3::UnitY()
                          : position < 2.0 ? Vec3::UnitZ()
                                           : Vec3::UnitX();
        const Vec3 to = position < 1.0   ? Vec3::UnitZ()
                        : position < 2.0 ? Vec3::UnitX()
                                         : Vec3::UnitY();
        return Vec3((1.0 - t) * from + t * to);
    };
    Vec3 center = Vec3::Zero();
    const std::vector<Spoke> spokes = spokes_of(node, e);
    for (const Spoke& s : spokes)
        center += place(s.position) / static_cast<double>(spokes.size());
    junction.weights = junction.weights.cwiseMax(margin);
    junction.weights /= junction.weights.sum();
    const HalfEdge sides[] = {e, Mesh::next(e), Mesh::previous(e)};
    for (const HalfEdge h : sides)
        for (const Index c : on_edge(h)) {
            const std::optional<double> end = chord_end(e, h, c);
            if (!end)
                continue;
            const double base = h == e ? 2.0 : h == Mesh::next(e) ? 0.0 : 1.0;
            const Vec3 a = place(base + position(c, h));
            const Vec3 b = place(*end);
            const auto side = [&](const Vec3& p) {
                return (b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x());
            };
            const double wanted = side(center);
            if (side(junction.weights) * wanted < 0.01 * wanted * wanted)
                junction.weights = 0.1 * junction.weights + 0.9 * center;
        }
}

} // namespace devseg::curves
