#include "devseg/mesh/input_gate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "devseg/base/buckets.h"
#include "devseg/base/errors.h"
#include "devseg/mesh/weld.h"

namespace devseg::mesh {

namespace {

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

// Centre and scale: afterwards the bounding box is about 1 wide. Returns where its middle was. The
// factor is a power of two, which changes no digit.
Vec3 normalise(const RawMesh& raw, Mesh& mesh) {
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
    return centre;
}

// Visits the items of each bucket, sorted.
template <class Item, class Visit>
void for_sorted(Buckets<Item> buckets, Visit visit) {
    for (Index b = 0; b < buckets.count(); ++b) {
        const auto first = buckets.items.begin() + buckets.begin[b];
        const auto last = buckets.items.begin() + buckets.begin[at(b) + 1];
        std::sort(first, last);
        visit(first, last);
    }
}

struct FaceSelection {
    std::vector<Index> kept;         // faces that go on
    std::vector<Index> duplicate_of; // #source faces: the earlier face on the same vertices, or −1
    Index repeated = 0;              // faces that name a vertex twice
    Index duplicates = 0;
};

FaceSelection select_proper_faces(const std::vector<Triangle>& faces, Index vertex_count) {
    const Range<FaceKind> all(0, static_cast<Index>(faces.size()));
    const auto sorted = [&](Face f) {
        Triangle t = faces[f];
        std::sort(t.begin(), t.end());
        return t;
    };
    using Key = std::array<Index, 3>; // middle vertex, largest vertex, face
    FaceSelection result;
    result.duplicate_of.assign(faces.size(), -1);
    for_sorted(make_buckets<Key>(vertex_count,
                                 [&](auto put) {
                                     for (const Face f : all) {
                                         const Triangle t = sorted(f);
                                         put(t[0], Key{t[1], t[2], f});
                                     }
                                 }),
               [&](auto key, auto last) {
                   if (key == last)
                       return;
                   for (auto before = key++; key != last; before = key++)
                       if ((*key)[0] == (*before)[0] && (*key)[1] == (*before)[1]) {
                           const Index first = result.duplicate_of[(*before)[2]];
                           result.duplicate_of[(*key)[2]] = first >= 0 ? first : (*before)[2];
                       }
               });
    result.kept.reserve(faces.size());
    for (const Face f : all) {
        const Triangle t = sorted(f);
        if (t[0] == t[1] || t[1] == t[2]) {
            result.duplicate_of[f] = -1;
            ++result.repeated;
        } else if (result.duplicate_of[f] >= 0) {
            ++result.duplicates;
        } else {
            result.kept.push_back(f);
        }
    }
    return result;
}

// All half-edges of each edge that has exactly two faces, whatever their directions.
std::vector<Index> neighbours_regardless_of_direction(const Mesh& mesh,
                                                      std::vector<std::uint8_t>& cut,
                                                      Index& crowded_edges) {
    std::vector<Index> neighbour(cut.size(), -1);
    using Use = std::pair<Index, Index>; // (larger vertex, half-edge)
    const auto put_all = [&](auto put) {
        for (const HalfEdge h : mesh.all_half_edges()) {
            const auto [low, high] = std::minmax({mesh.origin(h), mesh.target(h)});
            put(low, Use(high, h));
        }
    };
    for_sorted(make_buckets<Use>(mesh.vertex_count(), put_all), [&](auto run, auto last) {
        for (auto end = run; run != last; run = end) {
            while (end != last && end->first == run->first)
                ++end;
            if (end - run == 2) {
                neighbour[run->second] = (run + 1)->second;
                neighbour[(run + 1)->second] = run->second;
            } else if (end - run > 2) {
                ++crowded_edges;
                for (auto use = run; use != end; ++use)
                    cut[use->second] = 1;
            }
        }
    });
    return neighbour;
}

struct Orientation {
    std::vector<std::uint8_t> flipped; // #F
    Index turned = 0;                  // faces turned over
    Index one_sided_edges = 0;         // edges where no coherent orientation exists
};

// Breadth-first over each component; the orientation that most faces had is kept.
Orientation orient(const Mesh& mesh, std::vector<Index>& neighbour,
                   std::vector<std::uint8_t>& cut) {
    Orientation result;
    result.flipped.assign(mesh.faces.size(), 2); // 2 = not reached yet
    std::vector<Index> component;
    for (const Face seed : mesh.all_faces()) {
        if (result.flipped[seed] != 2)
            continue;
        component.assign(1, seed);
        result.flipped[seed] = 0;
        Index turned = 0;
        for (std::size_t i = 0; i < component.size(); ++i) {
            const Face f = component[i];
            turned += result.flipped[f];
            for (const HalfEdge h : half_edges_of(f)) {
                const HalfEdge opposite = neighbour[h];
                if (opposite < 0)
                    continue;
                // Two faces that run along their edge in the same direction disagree.
                const bool disagree = mesh.origin(h) == mesh.origin(opposite);
                const std::uint8_t wanted = result.flipped[f] ^ (disagree ? 1 : 0);
                std::uint8_t& state = result.flipped[face_of(opposite)];
                if (state == 2) {
                    state = wanted;
                    component.push_back(face_of(opposite));
                } else if (state != wanted) {
                    ++result.one_sided_edges;
                    cut[h] = cut[opposite] = 1;
                    neighbour[h] = neighbour[opposite] = -1;
                }
            }
        }
        const Index size = static_cast<Index>(component.size());
        if (2 * turned > size) {
            for (const Face f : component)
                result.flipped[f] ^= 1;
            turned = size - turned;
        }
        result.turned += turned;
    }
    return result;
}

// Gives every fan of faces around a vertex a vertex of its own. Returns how many were added.
Index split_fans(Mesh& mesh, std::vector<Index>& source_vertex) {
    std::vector<std::uint8_t> done(mesh.twin.size(), 0); // corner h is the origin of half-edge h
    std::vector<std::uint8_t> used(mesh.points.size(), 0);
    Index added = 0;
    for (const HalfEdge start : mesh.all_half_edges()) {
        if (done[start] != 0)
            continue;
        Vertex v = mesh.origin(start);
        if (used[v] != 0) {
            mesh.points.push_back(mesh.points[v]);
            source_vertex.push_back(source_vertex[v]);
            v = mesh.vertex_count() - 1;
            ++added;
        } else {
            used[v] = 1;
        }
        visit_star(mesh, start, [&](HalfEdge h) {
            mesh.faces[face_of(h)][corner_of(h)] = v;
            done[h] = 1;
        });
    }
    return added;
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

// Source faces that were left out take the results of a face on the same vertices, or of a face
// that shares an edge or a vertex with them.
void find_stand_ins(const std::vector<Triangle>& faces, std::size_t vertex_count,
                    const std::vector<Index>& duplicate_of, GatedMesh& gated) {
    gated.stand_in.assign(faces.size(), -1);
    for (std::size_t f = 0; f < gated.source_face.size(); ++f)
        gated.stand_in[gated.source_face[f]] = static_cast<Index>(f);
    if (gated.source_face.size() == faces.size())
        return;
    std::vector<Index> face_at_vertex(vertex_count, -1);
    for (std::size_t f = 0; f < gated.source_face.size(); ++f)
        for (const Vertex v : faces[gated.source_face[f]])
            face_at_vertex[v] = static_cast<Index>(f);
    for (std::size_t f = 0; f < faces.size(); ++f) {
        Index& stand_in = gated.stand_in[f];
        if (stand_in >= 0)
            continue;
        if (duplicate_of[f] >= 0)
            stand_in = gated.stand_in[duplicate_of[f]];
        for (const Vertex v : faces[f])
            if (stand_in < 0)
                stand_in = face_at_vertex[v];
        if (stand_in < 0)
            stand_in = 0;
    }
}

} // namespace

GatedMesh gate_mesh(const RawMesh& raw, const Progress& progress) {
    require_faces(raw);
    require_valid_indices(raw);
    require_finite(raw);

    GatedMesh gated;
    Mesh& mesh = gated.mesh;
    gated.center = normalise(raw, mesh);
    gated.source_vertex.resize(raw.points.size());
    std::iota(gated.source_vertex.begin(), gated.source_vertex.end(), 0);

    std::vector<Triangle> faces = raw.faces;
    progress.check();
    const Index welded = weld_soup(raw, faces);
    progress.check();
    FaceSelection selection = select_proper_faces(faces, mesh.vertex_count());
    gated.source_face = std::move(selection.kept);
    for (const Face f : gated.source_face)
        mesh.faces.push_back(faces[f]);

    progress.check();
    gated.cut.assign(3 * mesh.faces.size(), 0);
    Index crowded_edges = 0;
    std::vector<Index> neighbour =
        neighbours_regardless_of_direction(mesh, gated.cut, crowded_edges);
    progress.check();
    Orientation orientation = orient(mesh, neighbour, gated.cut);
    gated.flipped = std::move(orientation.flipped);

    progress.check();
    // Turn faces over: corners (a, b, c) become (a, c, b), so edge e becomes edge 2 − e.
    const auto moved = [&](HalfEdge h) {
        return gated.flipped[face_of(h)] != 0 ? half_edge_of(face_of(h), 2 - corner_of(h)) : h;
    };
    std::vector<std::uint8_t> cut(gated.cut.size());
    mesh.twin.assign(gated.cut.size(), -1);
    for (const HalfEdge h : mesh.all_half_edges()) {
        cut[moved(h)] = gated.cut[h];
        if (neighbour[h] >= 0)
            mesh.twin[moved(h)] = moved(neighbour[h]);
    }
    gated.cut = std::move(cut);
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
        if (gated.flipped[f] != 0)
            std::swap(mesh.faces[f][1], mesh.faces[f][2]);

    progress.check();
    const Index split = split_fans(mesh, gated.source_vertex);
    progress.check();
    drop_unused_points(mesh, gated.source_vertex);
    progress.check();
    compute_face_geometry(mesh);
    if (!(mesh.total_area > 0.0))
        throw InvalidMesh("expected a surface, found " +
                          counted(static_cast<Index>(raw.faces.size()), "face", "faces") +
                          " without any area; there is nothing to segment");
    progress.check();
    find_stand_ins(faces, raw.points.size(), selection.duplicate_of, gated);

    const auto note = [&](Index count, const char* one, const char* many, const char* rest) {
        if (count > 0)
            gated.notes.push_back(counted(count, one, many) + rest);
    };
    note(welded, "vertex was", "vertices were",
         " joined with others at the same place, as no two faces share one "
         "('Merge Close Vertices' with a threshold of 0 does it for good)");
    note(selection.repeated, "face repeats a vertex and was", "faces repeat a vertex and were",
         " left out ('Remove Zero Area Faces' drops such faces)");
    note(selection.duplicates, "face lies on the vertices of another one and was",
         "faces lie on the vertices of another one and were",
         " left out ('Remove Duplicate Faces' drops such faces)");
    note(crowded_edges, "edge has more than two faces and was",
         "edges have more than two faces and were",
         " cut ('Repair non Manifold Edges' mends them)");
    note(orientation.turned, "face was", "faces were",
         " read with the orientation of its neighbours "
         "('Re-Orient All Faces Coherently' does it for good)");
    note(orientation.one_sided_edges, "edge of a one-sided surface was",
         "edges of a one-sided surface were", " cut, as it has no coherent orientation");
    note(crowded_edges == 0 && orientation.one_sided_edges == 0 ? split : 0,
         "vertex joins fans of faces and was", "vertices join fans of faces and were",
         " split ('Repair non Manifold Vertices by Splitting')");
    return gated;
}

} // namespace devseg::mesh
