// Seams as curves that cross mesh edges, free of the mesh's vertices, and the moves that keep them
// apart: whatever is done with these moves, the charts keep their topology.
//
// A curve is the list of the edges that it crosses. In each face it is a straight chord between
// two crossings. Worked example, the seam u, v, w on three vertices of a mesh; it leaves v on its
// left side, where two edges of v leave v between the seam's edges:
//
//        x───y                          the curve:  u → (v x) → (v y) → w
//       ╱ ╲ ╱ ╲                         `edge` of the first crossing: the half-edge v → x of the
//      u───v───w                        face u v x that the curve leaves
//
// Curves end at nodes: vertices where they are fixed, or junctions that lie within a face and move.
//
// References
//   S. Bischoff, T. Weyand, L. Kobbelt: Snakes on Triangle Meshes. Bildverarbeitung für die
//   Medizin, 2005. doi:10.1007/3-540-26431-0_43 (points of a curve that slide along edges and pass
//   vertices)
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/curves/curved_vertices.h"

namespace devseg::curves {

struct Crossing {
    HalfEdge edge;    // of the face that the curve leaves
    double t = 0.5;   // where, from the origin of `edge` to its target
    Index curve = -1; // −1: no crossing any more
    Index previous = -1;
    Index next = -1; // along the curve; a closed curve has no ends
    Index below = -1;
    Index above = -1; // along the edge, see Network::on_edge
};

struct Node {
    Vertex vertex;               // where it is fixed, −1 for a junction
    Face face;                   // of a junction
    Vec3 weights{0.0, 0.0, 0.0}; // of a junction: barycentric coordinates in its face
    std::vector<Index> curves;   // that end here; twice those that begin here as well

    bool is_junction() const { return vertex < 0; }
};

struct Curve {
    std::vector<HalfEdge> path; // the seam edges that it stands for, in their order
    bool held = false;          // stays on them: no crossings
    Index start = -1;           // nodes, −1 for a closed curve
    Index end = -1;
    Index first = -1; // crossings; any for a closed curve; −1 for none
    Index last = -1;

    bool is_closed() const { return start < 0; }
};

class Network {
public:
    /// All seams of the charts. Those marked in `held` (3 #F, both half-edges of an edge) stay
    /// where they are, with their ends. The mesh must outlive the network.
    Network(const Mesh& mesh, const atlas::ChartMap& charts, const std::vector<std::uint8_t>& held,
            const CurvedVertices& curved);

    const Mesh& mesh;
    std::vector<Node> nodes;
    std::vector<Curve> curves;
    std::vector<Crossing> crossings;
    std::vector<std::uint8_t> occupied; // #V: 1 where a curve passes through the vertex

    /// The crossings of an edge, from the origin to the target of the half-edge.
    std::vector<Index> on_edge(HalfEdge h) const;
    /// Position of a crossing on its edge, from the origin of `h`, one of its half-edges.
    double position(Index crossing, HalfEdge h) const {
        return crossings[crossing].edge == h ? crossings[crossing].t : 1.0 - crossings[crossing].t;
    }
    /// The vertex at an end of the crossing's edge: on the curve's left or right side.
    Vertex beside(Index crossing, bool left) const {
        const HalfEdge h = crossings[crossing].edge;
        return left ? mesh.target(h) : mesh.origin(h);
    }
    /// No other crossing lies between this one and the end of its edge.
    bool is_nearest(Index crossing, bool left) const;

    /// Other crossings are on its edge.
    bool has_company(Index crossing) const {
        return crossings[crossing].above >= 0 || crossings[crossing].below >= 0;
    }

    /// Takes the curve to the other side of a vertex. `first` to `last` are all its crossings on
    /// the edges of the vertex, one after the other. False where something is in the way: then
    /// nothing has changed.
    bool pass(Index first, Index last, bool left);

    /// Takes a junction to the other side of an edge of its face, at t of the edge. False where
    /// something is in the way: then nothing has changed.
    bool push(Index node, HalfEdge e, double t);

    /// Moves a junction onto a vertex of its face, where it stays. False where something is in the
    /// way: then nothing has changed.
    bool pin(Index node, Index corner);

    /// Spreads crossings of an edge that are out of order or nearer to each other and to its ends
    /// than `gap`, a share of the edge; less where there is not so much room.
    void keep_apart(HalfEdge h, double gap);

    /// Moves a junction back in between the curves that pass through its face, with barycentric
    /// coordinates of at least `margin`.
    void keep_inside(Index node, double margin);

    /// The first crossing of a curve from one of its ends, and the one after another.
    Index from_end(const Curve& curve, bool start) const {
        return start ? curve.first : curve.last;
    }
    Index after(Index crossing, bool forwards) const {
        return forwards ? crossings[crossing].next : crossings[crossing].previous;
    }
    /// The half-edge over which the curve leaves its face in this direction.
    HalfEdge leaving(Index crossing, bool forwards) const {
        const HalfEdge h = crossings[crossing].edge;
        return forwards ? h : mesh.twin[h];
    }

private:
    friend class NetworkBuilder;
    struct Spoke; // a curve that leaves a junction

    Index insert(HalfEdge edge, double t, Index curve, Index previous, Index next);
    void remove(Index crossing);
    void link_on_edge(Index crossing);
    void unlink_on_edge(Index crossing);
    bool is_undone(Index crossing) const;
    void reduce_from(Index crossing);
    void drop_spurs(Curve& curve);
    std::vector<Spoke> spokes_of(Index node, HalfEdge e) const;
    std::optional<double> chord_end(HalfEdge e, HalfEdge h, Index crossing) const;
    bool is_walled_off(HalfEdge e, const std::vector<Spoke>& spokes) const;
    std::pair<double, double> gap_on(HalfEdge e, const std::vector<Spoke>& spokes) const;

    std::vector<Index> lowest_; // 3 #F: the first crossing of the edge, at its lower half-edge
    std::vector<Index> junctions_in_; // #F: junctions in the face
};

} // namespace devseg::curves
