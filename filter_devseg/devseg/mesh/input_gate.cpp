#include "devseg/mesh/input_gate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "devseg/base/errors.h"
#include "devseg/graph/unions.h"
#include "devseg/mesh/coherent_faces.h"
#include "devseg/mesh/empty_edges.h"
#include "devseg/mesh/empty_parts.h"
#include "devseg/mesh/inside_out.h"
#include "devseg/mesh/stand_ins.h"
#include "devseg/mesh/weld.h"

namespace devseg::mesh {

namespace {

// Of the model's size: narrower parts have no area. A pattern of a metre shows them 1 µm wide, and
// coordinates of 32 bits tell them from a line by a few steps only.
constexpr double narrow_part = 1e-6;

std::string counted(Index count, const char* one, const char* many) {
    return std::to_string(count) + ' ' + (count == 1 ? one : many);
}

void require_faces(const RawMesh& raw) {
    if (raw.faces.empty())
        throw InvalidMesh("expected a triangle mesh, found " +
                          counted(static_cast<Index>(raw.points.size()), "vertex", "vertices") +
                          " and no faces; reconstruct a surface first (for a point cloud: "
                          "'Surface Reconstruction: Screened Poisson')");
}

void require_valid_indices(const RawMesh& raw) {
    const Index count = static_cast<Index>(raw.points.size());
    for (std::size_t f = 0; f < raw.faces.size(); ++f)
        for (const Vertex v : raw.faces[f])
            if (v < 0 || v >= count)
                throw InvalidMesh("expected vertex indices from 0 to " + std::to_string(count - 1) +
                                      ", found " + std::to_string(v) + " in face " +
                                      std::to_string(f) + "; mend the file",
                                  {static_cast<Index>(f)});
}

void require_finite(const RawMesh& raw) {
    std::vector<Index> bad;
    Index first_vertex = -1;
    for (std::size_t f = 0; f < raw.faces.size(); ++f)
        for (const Vertex v : raw.faces[f])
            if (!raw.points[v].allFinite()) {
                if (first_vertex < 0)
                    first_vertex = v;
                bad.push_back(static_cast<Index>(f));
                break;
            }
    if (!bad.empty())
        throw InvalidMesh("expected finite coordinates, found a NaN or an infinite number at "
                          "vertex " +
                              std::to_string(first_vertex) + " (" +
                              counted(static_cast<Index>(bad.size()), "face", "faces") +
                              " affected, first face " + std::to_string(bad.front()) +
                              "); delete these faces, they have been selected "
                              "('Delete Selected Faces and Vertices')",
                          bad);
}

// Centre and scale: afterwards the bounding box is about 1 wide. Returns how it was before. The
// factor is a power of two, which changes no digit.
struct Frame {
    Vec3 center;
    double size; // longest side of the box, internal units: 1 to 2
};

Frame normalise(const RawMesh& raw, Mesh& mesh) {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::max());
    Vec3 high = -low;
    for (const Triangle& t : raw.faces)
        for (const Vertex v : t) {
            low = low.cwiseMin(raw.points[v]);
            high = high.cwiseMax(raw.points[v]);
        }
    const double size = (high / 2.0 - low / 2.0).maxCoeff() * 2.0;
    if (!(size > 0.0) || !std::isfinite(size))
        throw InvalidMesh(size > 0.0
                              ? "expected a model of a finite size, found coordinates that are "
                                "too large to measure; scale the model down"
                              : "expected a surface, found all vertices at one point; "
                                "there is nothing to segment");
    const Vec3 centre = low / 2.0 + high / 2.0;
    mesh.unit_length = std::ldexp(1.0, std::ilogb(size));
    mesh.points.resize(raw.points.size());
    for (std::size_t v = 0; v < raw.points.size(); ++v)
        mesh.points[v] = (raw.points[v] - centre) / mesh.unit_length;
    return {centre, size / mesh.unit_length};
}

// Turns faces over (#F marks): corners (a, b, c) become (a, c, b), so edge e becomes edge 2 − e.
void turn_over(GatedMesh& gated, const std::vector<std::uint8_t>& turned) {
    Mesh& mesh = gated.mesh;
    const auto moved = [&](HalfEdge h) {
        return turned[face_of(h)] != 0 ? half_edge_of(face_of(h), 2 - corner_of(h)) : h;
    };
    std::vector<std::uint8_t> cut(gated.cut.size());
    std::vector<HalfEdge> twin(mesh.twin.size());
    for (const HalfEdge h : mesh.all_half_edges()) {
        cut[moved(h)] = gated.cut[h];
        if (mesh.twin[h] >= 0)
            twin[moved(h)] = moved(mesh.twin[h]);
    }
    gated.cut = std::move(cut);
    mesh.twin = std::move(twin);
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
        if (turned[f] != 0) {
            gated.flipped[f] ^= 1;
            std::swap(mesh.faces[f][1], mesh.faces[f][2]);
        }
}

// Leaves out marked faces (#F), which have no neighbours among the others. Returns how many.
Index leave_out(GatedMesh& gated, const std::vector<std::uint8_t>& marked) {
    Mesh& mesh = gated.mesh;
    std::vector<Index> number(mesh.faces.size(), -1);
    Index count = 0;
    for (const Face f : mesh.all_faces())
        if (marked[f] == 0)
            number[f] = count++;
    for (const Face f : mesh.all_faces()) {
        const Index to = number[f];
        if (to < 0)
            continue;
        mesh.faces[to] = mesh.faces[f];
        gated.source_face[to] = gated.source_face[f];
        gated.flipped[to] = gated.flipped[f];
        for (const HalfEdge h : half_edges_of(f)) {
            const HalfEdge moved = half_edge_of(to, corner_of(h));
            const HalfEdge twin = mesh.twin[h];
            mesh.twin[moved] =
                twin < 0 ? HalfEdge(-1) : half_edge_of(number[face_of(twin)], corner_of(twin));
            gated.cut[moved] = gated.cut[h];
        }
    }
    const auto left_out = static_cast<Index>(mesh.faces.size()) - count;
    mesh.faces.resize(at(count));
    gated.source_face.resize(at(count));
    gated.flipped.resize(at(count));
    mesh.twin.resize(3 * at(count));
    gated.cut.resize(3 * at(count));
    return left_out;
}

// Gives every fan of faces around a vertex a vertex of its own, and one alone. Returns how many
// were added, and how many became one with others.
std::pair<Index, Index> split_fans(Mesh& mesh, std::vector<Index>& source_vertex) {
    std::vector<std::uint8_t> done(mesh.twin.size(), 0); // corner h is the origin of half-edge h
    std::vector<std::uint8_t> used(mesh.points.size(), 0);
    graph::Unions joined(mesh.points.size());
    Index added = 0;
    Index less = 0;
    for (const HalfEdge start : mesh.all_half_edges()) {
        if (done[start] != 0)
            continue;
        const Vertex source = mesh.origin(start);
        Vertex v = source;
        if (used[v] != 0) {
            mesh.points.push_back(mesh.points[v]);
            source_vertex.push_back(source_vertex[v]);
            v = mesh.vertex_count() - 1;
            ++added;
        } else {
            used[v] = 1;
        }
        visit_star(mesh, start, [&](HalfEdge h) {
            const auto [first, other] =
                std::minmax({joined.find(source), joined.find(mesh.origin(h))});
            less += first != other ? 1 : 0;
            joined.join(first, other);
            mesh.faces[face_of(h)][corner_of(h)] = v;
            done[h] = 1;
        });
    }
    for (Index& source : source_vertex)
        source = joined.find(source);
    return {added, less};
}

// Drops the points that no face uses.
void drop_unused_points(Mesh& mesh, std::vector<Index>& source_vertex) {
    std::vector<Index> renamed(mesh.points.size(), -1);
    for (const Triangle& t : mesh.faces)
        for (const Vertex v : t)
            renamed[v] = 0;
    Index count = 0;
    for (std::size_t v = 0; v < renamed.size(); ++v)
        if (renamed[v] == 0) {
            renamed[v] = count;
            mesh.points[count] = mesh.points[v];
            source_vertex[count] = source_vertex[v];
            ++count;
        }
    mesh.points.resize(at(count));
    source_vertex.resize(at(count));
    for (Triangle& t : mesh.faces)
        for (Index& v : t)
            v = renamed[v];
}

// Edges that had to be cut.
Index count_cut_edges(const GatedMesh& gated) {
    std::vector<std::pair<Index, Index>> edges;
    for (const HalfEdge h : gated.mesh.all_half_edges())
        if (gated.cut[h] != 0)
            edges.push_back(
                std::minmax({Index{gated.mesh.origin(h)}, Index{gated.mesh.target(h)}}));
    std::sort(edges.begin(), edges.end());
    return static_cast<Index>(std::unique(edges.begin(), edges.end()) - edges.begin());
}

// What was worked around, as numbers.
struct Found {
    Index joined = 0;         // vertices that there are less
    Index drawn_together = 0; // and those less that edges without length joined
    Index repeated = 0;
    Index duplicates = 0;
    Index without_area = 0; // faces of parts without area
    Index crowded = 0;
    Index turned = 0;
    Index one_sided = 0;
    Index split = 0;
    Index inside_out = 0;
};

std::vector<std::string> notes_of(const Found& found, const GateOptions& options) {
    std::vector<std::string> notes;
    const auto note = [&](Index count, const char* one, const char* many, const std::string& rest) {
        if (count > 0)
            notes.push_back(counted(count, one, many) + rest);
    };
    note(found.joined, "vertex was", "vertices were",
         std::string(" joined with others ") +
             (options.weld > 0.0 ? "nearby" : "at the same place") +
             ", as that closes open edges ('Merge Close Vertices' does it for good)");
    note(found.drawn_together, "vertex was", "vertices were",
         " joined with others at the same place, as edges without length lead there ('Merge Close "
         "Vertices' does it for good)");
    note(found.repeated, "face repeats a vertex and was", "faces repeat a vertex and were",
         " left out ('Remove Zero Area Faces' drops such faces)");
    note(found.duplicates, "face lies on the vertices of another one and was",
         "faces lie on the vertices of another one and were",
         " left out ('Remove Duplicate Faces' drops such faces)");
    note(found.without_area, "face belongs to a part without area and was",
         "faces belong to parts without area and were", " left out");
    note(found.crowded, "edge has more than two faces and was",
         "edges have more than two faces and were",
         " cut ('Repair non Manifold Edges' mends them)");
    note(found.turned, "face was", "faces were",
         " read with the orientation of its neighbours "
         "('Re-Orient All Faces Coherently' does it for good)");
    note(found.one_sided, "edge of a one-sided surface was", "edges of a one-sided surface were",
         " cut, as it has no coherent orientation");
    note(found.split, "vertex joins fans of faces and was", "vertices join fans of faces and were",
         " split ('Repair non Manifold Vertices by Splitting')");
    note(found.inside_out, "closed surface is", "closed surfaces are",
         std::string(" inside out") +
             (options.turn_inside_out ? ": read turned over" : "; patterns are turned over") +
             " ('Invert Faces Orientation' does it for good)");
    return notes;
}

// Pairs of borders that lie on each other become edges.
void join_borders(const std::vector<std::array<HalfEdge, 2>>& pairs, GatedMesh& gated) {
    for (const auto& [h, other] : pairs) {
        gated.mesh.twin[h] = other;
        gated.mesh.twin[other] = h;
        gated.cut[h] = gated.cut[other] = 0;
    }
}

// Sets twins, orientation and cuts of the faces that were kept. The crowded edges of a soup are
// borders that touch: nobody has put more than two faces on them.
void connect(bool is_soup, const GateOptions& options, double tolerance, GatedMesh& gated,
             Found& found, const Progress& progress) {
    Mesh& mesh = gated.mesh;
    mesh.twin = neighbours_regardless_of_direction(mesh, gated.cut);
    progress.check();
    const Orientation orientation = orient(mesh, mesh.twin, gated.cut);
    found.turned = orientation.turned;
    found.one_sided = orientation.one_sided_edges;
    gated.flipped.assign(mesh.faces.size(), 0);
    turn_over(gated, orientation.flipped);
    progress.check();
    const std::vector<std::uint8_t> left_out =
        is_soup ? std::vector<std::uint8_t>(gated.cut.size(), 0) : gated.cut;
    const auto pairs = coincident_borders(mesh, left_out, tolerance, progress);
    if (options.weld >= 0.0)
        join_borders(pairs, gated);
    found.crowded = count_cut_edges(gated) - found.one_sided;
    if (options.weld < 0.0)
        for (const auto& pair : pairs)
            for (const HalfEdge h : pair)
                gated.cut[h] = 1;
    progress.check();
    std::vector<std::uint8_t> inside_out;
    found.inside_out = find_inside_out(mesh, inside_out);
    if (options.turn_inside_out && found.inside_out > 0)
        turn_over(gated, inside_out);
}

} // namespace

const CollapsedFace* GatedMesh::find_collapsed(Index source) const {
    const auto found =
        std::lower_bound(collapsed.begin(), collapsed.end(), source,
                         [](const CollapsedFace& c, Index face) { return c.source < face; });
    return found != collapsed.end() && found->source == source ? &*found : nullptr;
}

GatedMesh gate_mesh(const RawMesh& raw, const GateOptions& options, const Progress& progress) {
    require_faces(raw);
    require_valid_indices(raw);
    require_finite(raw);

    GatedMesh gated;
    Mesh& mesh = gated.mesh;
    const Frame frame = normalise(raw, mesh);
    const double tolerance = std::max(0.0, options.weld) * frame.size;
    gated.center = frame.center;
    gated.source_vertex.resize(raw.points.size());
    std::iota(gated.source_vertex.begin(), gated.source_vertex.end(), 0);

    Found found;
    std::vector<Triangle> faces = raw.faces;
    progress.check();
    const Index welded = options.weld >= 0.0 ? weld_soup(mesh.points, tolerance, faces) : 0;
    progress.check();
    if (options.weld >= 0.0)
        found.drawn_together = join_ends_of_empty_edges(mesh.points, faces);
    progress.check();
    FaceSelection selection = select_proper_faces(faces, mesh.vertex_count());
    found.repeated = selection.repeated;
    found.duplicates = selection.duplicates;
    gated.source_face = std::move(selection.kept);
    for (const Face f : gated.source_face)
        mesh.faces.push_back(faces[f]);
    progress.check();
    connect(welded > 0, options, tolerance, gated, found, progress);
    progress.check();
    found.without_area = leave_out(gated, find_empty_parts(mesh, narrow_part * frame.size));
    progress.check();
    const auto [split, joined] = split_fans(mesh, gated.source_vertex);
    found.joined = welded + joined;
    if (found.crowded == 0 && found.one_sided == 0 && welded == 0)
        found.split = split;
    progress.check();
    drop_unused_points(mesh, gated.source_vertex);
    progress.check();
    compute_face_geometry(mesh);
    if (!(mesh.total_area > 0.0))
        throw InvalidMesh("expected a surface, found " +
                          counted(static_cast<Index>(raw.faces.size()), "face", "faces") +
                          " without any area; there is nothing to segment");
    progress.check();
    find_stand_ins({raw.faces, faces, selection.duplicate_of}, raw.points.size(), gated);
    gated.notes = notes_of(found, options);
    return gated;
}

} // namespace devseg::mesh
