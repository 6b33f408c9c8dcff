// Seams along mesh edges → curves beside their vertices.
#include <algorithm>
#include <cmath>

#include "devseg/curves/network.h"

namespace devseg::curves {

namespace {

struct Tuning {
    double beside_path = 0.1; // of an edge: how far from the seam's vertices curves begin
};
constexpr Tuning tuning;

double corner_angle(const Mesh& mesh, HalfEdge h) {
    const Vec3 a = mesh.points[mesh.target(h)] - mesh.points[mesh.origin(h)];
    const Vec3 b = mesh.points[mesh.apex(h)] - mesh.points[mesh.origin(h)];
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

struct Step {
    HalfEdge edge;
    double t;
};

} // namespace

class NetworkBuilder {
public:
    NetworkBuilder(Network& network, const atlas::ChartMap& charts,
                   const std::vector<std::uint8_t>& held, const CurvedVertices& curved)
        : net_(network), mesh_(network.mesh), charts_(charts), held_(held), curved_(curved) {}

    void build() {
        find_nodes();
        trace_curves();
        place_junctions();
        for (Index i = 0; i < static_cast<Index>(net_.curves.size()); ++i)
            if (!net_.curves[i].held)
                cross_edges(i);
    }

private:
    bool is_seam(HalfEdge h) const { return mesh_.twin[h] >= 0 && charts_.seam[h] != 0; }
    bool is_held(HalfEdge h) const { return held_[h] != 0; }

    // Vertices where curves end: all but those inside of a seam.
    void find_nodes() {
        node_of_.assign(mesh_.points.size(), -1);
        leaving_.assign(mesh_.points.size(), HalfEdge());
        degree_.assign(mesh_.points.size(), 0);
        std::vector<Index> held(mesh_.points.size(), 0);
        std::vector<std::uint8_t> on_border(mesh_.points.size(), 0);
        for (const HalfEdge h : mesh_.all_half_edges()) {
            const Vertex v = mesh_.origin(h);
            if (mesh_.twin[h] < 0)
                on_border[v] = on_border[mesh_.target(h)] = 1;
            if (!is_seam(h))
                continue;
            leaving_[v] = h;
            ++degree_[v];
            held[v] += is_held(h) ? 1 : 0;
        }
        net_.occupied = on_border;
        for (const Vertex v : Range<VertexKind>(0, mesh_.vertex_count())) {
            if (degree_[v] == 0)
                continue;
            const bool kept = held[v] == 0 && curved_.keeps_seams(v);
            const bool inside =
                degree_[v] == 2 && on_border[v] == 0 && !kept && (held[v] == 0 || held[v] == 2);
            if (inside) {
                net_.occupied[v] = held[v] != 0 ? 1 : 0;
                continue;
            }
            node_of_[v] = static_cast<Index>(net_.nodes.size());
            Node node;
            node.vertex = v;
            net_.nodes.push_back(node);
            net_.occupied[v] = 1;
            if (degree_[v] > 2 && on_border[v] == 0 && held[v] == 0 && !kept)
                movable_.push_back(node_of_[v]);
        }
    }

    HalfEdge next_on_path(HalfEdge h) const {
        HalfEdge next;
        mesh::visit_star(mesh_, Mesh::next(h), [&](HalfEdge leaving) {
            if (is_seam(leaving) && leaving != mesh_.twin[h])
                next = leaving;
        });
        return next;
    }

    void trace(HalfEdge start, std::vector<std::uint8_t>& done) {
        Curve curve;
        curve.held = is_held(start);
        const auto number = static_cast<Index>(net_.curves.size());
        HalfEdge h = start;
        do {
            curve.path.push_back(h);
            done[h] = done[mesh_.twin[h]] = 1;
            if (node_of_[mesh_.target(h)] >= 0)
                break;
            h = next_on_path(h);
        } while (h != start);
        curve.start = node_of_[mesh_.origin(start)];
        curve.end = node_of_[mesh_.target(curve.path.back())];
        for (const Index node : {curve.start, curve.end})
            if (node >= 0)
                net_.nodes[node].curves.push_back(number);
        net_.curves.push_back(std::move(curve));
    }

    void trace_curves() {
        std::vector<std::uint8_t> done(mesh_.twin.size(), 0);
        for (const bool from_nodes : {true, false})
            for (const HalfEdge h : mesh_.all_half_edges())
                if (is_seam(h) && done[h] == 0 && (!from_nodes || node_of_[mesh_.origin(h)] >= 0))
                    trace(h, done);
    }

    // Does the curve pass the end of this edge of its path on its left?
    bool leaves_left(const Curve& curve, std::size_t i) const {
        const HalfEdge in = curve.path[i];
        const HalfEdge out = curve.path[(i + 1) % curve.path.size()];
        double left = 0.0;
        double right = 0.0;
        for (HalfEdge g = Mesh::next(in);; g = Mesh::next(mesh_.twin[g])) {
            left += corner_angle(mesh_, g);
            if (g == out)
                break;
        }
        for (HalfEdge g = mesh_.twin[in]; g != out; g = mesh_.twin[Mesh::previous(g)])
            right += corner_angle(mesh_, g);
        return left <= right;
    }

    // A junction goes into a face beside its vertex; the curves that leave it go around the vertex,
    // those that turn farther nearer to it.
    void place_junctions() {
        sides_.resize(net_.curves.size());
        for (std::size_t c = 0; c < net_.curves.size(); ++c) {
            const Curve& curve = net_.curves[c];
            const std::size_t inner = curve.path.size() - (curve.is_closed() ? 0 : 1);
            for (std::size_t i = 0; !curve.held && i < inner; ++i)
                sides_[c].push_back(leaves_left(curve, i) ? 1 : 0);
        }
        routes_.resize(2 * net_.curves.size());
        for (const Index node : movable_)
            place_junction(node);
    }

    void place_junction(Index node) {
        Node& junction = net_.nodes[node];
        const Vertex v = junction.vertex;
        std::vector<HalfEdge> fan; // counterclockwise, each the left edge of the face before it
        HalfEdge h = leaving_[v];
        do {
            fan.push_back(h);
            h = mesh_.twin[Mesh::previous(h)];
        } while (h != leaving_[v]);
        const auto count = static_cast<Index>(fan.size());
        junction.face = face_of(fan.front());
        junction.weights = Vec3::Constant(tuning.beside_path);
        junction.weights[corner_of(fan.front())] = 1.0 - 2.0 * tuning.beside_path;
        junction.vertex = Vertex();
        ++net_.junctions_in_[junction.face];
        net_.occupied[v] = 0;

        // Face i is that of fan[i]; edge i lies between faces i − 1 and i, edge `count` is edge 0.
        struct Way {
            Index route;
            Index edge;
            Index goal; // face; count stands for face 0
        };
        std::vector<Way> ways;
        std::vector<Index> own = junction.curves;
        std::sort(own.begin(), own.end());
        own.erase(std::unique(own.begin(), own.end()), own.end());
        for (const Index c : own)
            for (const bool start : {true, false}) {
                const Curve& curve = net_.curves[c];
                if ((start ? curve.start : curve.end) != node)
                    continue;
                const HalfEdge out = start ? curve.path.front() : mesh_.twin[curve.path.back()];
                Index k = static_cast<Index>(std::find(fan.begin(), fan.end(), out) - fan.begin());
                k = k == 0 ? count : k;
                ways.push_back({2 * c + (start ? 0 : 1), k, first_is_left(c, start) ? k : k - 1});
            }
        std::sort(ways.begin(), ways.end(),
                  [](const Way& a, const Way& b) { return a.edge < b.edge; });
        const double ways_count = static_cast<double>(ways.size() + 1);
        for (std::size_t i = 0; i < ways.size(); ++i) {
            const Way& way = ways[i];
            std::vector<Step>& route = routes_[way.route];
            const bool counterclockwise = 2 * way.edge <= count;
            const double rank = static_cast<double>(counterclockwise ? ways.size() - i : i + 1);
            const double t = tuning.beside_path * rank / ways_count;
            if (counterclockwise)
                for (Index k = 1; k <= way.goal; ++k)
                    route.push_back({mesh_.twin[fan[k % count]], 1.0 - t});
            else
                for (Index k = count; k > way.goal; --k)
                    route.push_back({fan[k % count], t});
        }
    }

    // Is the curve's first chord, seen from that end outwards, on the left of its first edge?
    bool first_is_left(Index c, bool start) const {
        if (sides_[c].empty())
            return start; // the left of the path
        return start ? sides_[c].front() != 0 : sides_[c].back() == 0;
    }

    void add_fan(HalfEdge in, HalfEdge out, bool left, std::vector<Step>& steps) const {
        if (left)
            for (HalfEdge g = Mesh::next(in); g != out; g = Mesh::next(mesh_.twin[g]))
                steps.push_back({g, tuning.beside_path});
        else
            for (HalfEdge g = Mesh::previous(mesh_.twin[in]); mesh_.twin[g] != out;
                 g = Mesh::previous(mesh_.twin[g]))
                steps.push_back({g, 1.0 - tuning.beside_path});
    }

    void cross_edges(Index number) {
        const Curve& curve = net_.curves[number];
        const std::vector<HalfEdge>& path = curve.path;
        const std::vector<std::uint8_t>& sides = sides_[number];
        std::vector<Step> steps = routes_[2 * at(number)];
        for (std::size_t i = 0; i < sides.size(); ++i) {
            const HalfEdge out = path[(i + 1) % path.size()];
            add_fan(path[i], out, sides[i] != 0, steps);
            const bool last = i + 1 == sides.size();
            if (last && !curve.is_closed())
                break;
            if (sides[i] != sides[last ? 0 : i + 1])
                steps.push_back({sides[i] != 0 ? out : mesh_.twin[out], 0.5});
        }
        const std::vector<Step>& back = routes_[2 * at(number) + 1];
        for (std::size_t i = back.size(); i-- > 0;)
            steps.push_back({mesh_.twin[back[i].edge], 1.0 - back[i].t});
        Index last = -1;
        for (const Step& step : steps)
            last = net_.insert(step.edge, step.t, number, last, -1);
        if (curve.is_closed() && last >= 0) {
            net_.crossings[last].next = curve.first;
            net_.crossings[curve.first].previous = last;
        }
        pending_.push_back(number);
    }

public:
    // Curves that turn back on themselves do so no longer; once all of them are there.
    void reduce() {
        for (const Index number : pending_) {
            Curve& curve = net_.curves[number];
            for (Index c = curve.first; c >= 0;) {
                const Index next = net_.crossings[c].next;
                if (net_.is_undone(c)) {
                    const Index before = net_.crossings[c].previous;
                    net_.reduce_from(c);
                    c = before >= 0 && net_.crossings[before].curve == number ? before
                                                                              : curve.first;
                    continue;
                }
                if (c == curve.last)
                    break;
                c = next;
            }
            net_.drop_spurs(curve);
        }
    }

private:
    Network& net_;
    const Mesh& mesh_;
    const atlas::ChartMap& charts_;
    const std::vector<std::uint8_t>& held_;
    const CurvedVertices& curved_;
    std::vector<Index> node_of_;    // #V
    std::vector<HalfEdge> leaving_; // #V: a seam edge that leaves
    std::vector<Index> degree_;     // #V: seam edges
    std::vector<Index> movable_;    // nodes that become junctions
    std::vector<std::vector<std::uint8_t>>
        sides_; // of each curve: vertices inside passed on the left
    std::vector<std::vector<Step>>
        routes_; // at 2 c and 2 c + 1: around the ends of curve c, outwards
    std::vector<Index> pending_;
};

Network::Network(const Mesh& surface, const atlas::ChartMap& charts,
                 const std::vector<std::uint8_t>& held, const CurvedVertices& curved)
    : mesh(surface), lowest_(surface.twin.size(), -1), junctions_in_(surface.faces.size(), 0) {
    NetworkBuilder builder(*this, charts, held, curved);
    builder.build();
    builder.reduce();
}

} // namespace devseg::curves
