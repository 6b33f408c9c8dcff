#include "devseg/methods/plush/working_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "devseg/atlas/charts.h"
#include "devseg/mesh/coarsen.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

// Vertices, edges and faces of a surface: V − E + F.
Index euler_characteristic(const Mesh& mesh) {
    std::vector<std::uint8_t> used(mesh.points.size(), 0);
    Index twice = 0;
    for (const HalfEdge h : mesh.all_half_edges()) {
        used[mesh.origin(h)] = 1;
        twice += mesh.twin[h] < 0 ? 2 : 1;
    }
    const auto vertices = static_cast<Index>(std::count(used.begin(), used.end(), 1));
    return vertices - twice / 2 + mesh.face_count();
}

void link_twins(Mesh& mesh) {
    std::vector<std::array<Index, 3>> edges; // lower and higher vertex, half-edge
    for (const HalfEdge h : mesh.all_half_edges())
        edges.push_back({std::min<Index>(mesh.origin(h), mesh.target(h)),
                         std::max<Index>(mesh.origin(h), mesh.target(h)), h});
    std::sort(edges.begin(), edges.end());
    mesh.twin.assign(3 * mesh.faces.size(), -1);
    for (std::size_t i = 0; i + 1 < edges.size(); ++i)
        if (edges[i][0] == edges[i + 1][0] && edges[i][1] == edges[i + 1][1]) {
            mesh.twin[edges[i][2]] = edges[i + 1][2];
            mesh.twin[edges[i + 1][2]] = edges[i][2];
        }
}

// Two vertices of the whole: the ends of an edge that the plane cuts, or twice the same one.
using Ends = std::array<Index, 2>;

// What lies on one side of a plane.
struct Half {
    Mesh mesh;
    std::vector<Ends> ends; // #V: where its vertices are on the whole
};

// Cuts a mesh along a plane and keeps what lies below it.
class Slicer {
public:
    Slicer(const Mesh& mesh, const MirrorPlane& plane)
        : mesh_(mesh), plane_(plane), crossing_(mesh.twin.size(), -1) {
        snap_vertices();
        for (const Vertex v : mesh.all_vertices())
            ends_.push_back({v, v});
    }

    Half slice() {
        Mesh half;
        half.points = points_;
        half.unit_length = mesh_.unit_length;
        for (const Face f : mesh_.all_faces())
            add_part(f, half);
        link_twins(half);
        mesh::compute_face_geometry(half);
        return {std::move(half), ends_};
    }

private:
    void snap_vertices() {
        points_ = mesh_.points;
        std::vector<double> shortest(points_.size(), infinite);
        for (const HalfEdge h : mesh_.all_half_edges())
            for (const Vertex v : {mesh_.origin(h), mesh_.target(h)})
                shortest[v] = std::min(shortest[v], mesh_.edge_length(h));
        for (std::size_t v = 0; v < points_.size(); ++v) {
            height_.push_back(plane_.height(points_[v]));
            if (std::abs(height_[v]) > tuning.plane_snap * shortest[v])
                continue;
            points_[v] -= height_[v] * plane_.normal;
            height_[v] = 0.0;
        }
    }

    Index crossing(HalfEdge h, Mesh& half) {
        const HalfEdge twin = mesh_.twin[h];
        if (crossing_[h] < 0) {
            const Index a = std::min(mesh_.origin(h), mesh_.target(h));
            const Index b = std::max(mesh_.origin(h), mesh_.target(h));
            const double t = height_[a] / (height_[a] - height_[b]);
            crossing_[h] = half.vertex_count();
            if (twin >= 0)
                crossing_[twin] = crossing_[h];
            const Vec3 p = points_[a] + t * (points_[b] - points_[a]);
            half.points.push_back(p - plane_.height(p) * plane_.normal);
            ends_.push_back({a, b});
        }
        return crossing_[h];
    }

    void add_part(Face f, Mesh& half) {
        const auto height = [&](Vertex v) { return height_[v]; };
        std::vector<Index> corners;
        bool is_below = false;
        for (const HalfEdge h : half_edges_of(f)) {
            const Index a = mesh_.origin(h);
            const Index b = mesh_.target(h);
            is_below = is_below || height(a) < 0.0;
            if (height(a) <= 0.0)
                corners.push_back(a);
            if (height(a) * height(b) < 0.0)
                corners.push_back(crossing(h, half));
        }
        if (!is_below || corners.size() < 3)
            return;
        const auto distance = [&](std::size_t i, std::size_t k) {
            return (half.points[corners[i]] - half.points[corners[k]]).norm();
        };
        if (corners.size() == 4 && distance(1, 3) < distance(0, 2))
            std::rotate(corners.begin(), corners.begin() + 1, corners.end());
        for (std::size_t k = 2; k < corners.size(); ++k)
            half.faces.push_back({corners[0], corners[k - 1], corners[k]});
    }

    const Mesh& mesh_;
    const MirrorPlane& plane_;
    std::vector<Vec3> points_;
    std::vector<double> height_;  // #V
    std::vector<Index> crossing_; // 3 #F: new vertex on the edge
    std::vector<Ends> ends_;      // #V of the half
};

// Without small pieces, and with one fan of faces at each vertex.
Half clean_half(const Half& sliced, double surface_area) {
    const Mesh& half = sliced.mesh;
    const mesh::FaceComponents pieces = mesh::face_components(half, [](Index) { return true; });
    std::vector<double> area(at(pieces.count), 0.0);
    for (std::size_t f = 0; f < half.faces.size(); ++f)
        area[pieces.label[f]] += half.face_areas[f];
    std::vector<Index> kept;
    for (const Face f : half.all_faces())
        if (area[pieces.label[f]] > tuning.speck * surface_area)
            kept.push_back(f);
    const atlas::ChartSurface surface =
        atlas::extract_surface(half, kept, std::vector<std::uint8_t>(half.twin.size()));
    Half clean{atlas::mesh_of(half, surface), {}};
    for (const Vertex v : surface.vertex)
        clean.ends.push_back(sliced.ends[v]);
    return clean;
}

// One of two ends each, so that the closed line from one to the next is shortest.
std::vector<Index> shortest_loop(const Mesh& whole, const std::vector<Ends>& ends) {
    const std::size_t count = ends.size();
    std::vector<Index> best;
    double least = infinite;
    constexpr std::array<std::size_t, 2> both{0, 1};
    for (const std::size_t first : both) {
        std::array<double, 2> length{infinite, infinite};
        length[first] = 0.0;
        std::vector<std::array<std::size_t, 2>> before(count + 1);
        for (std::size_t i = 1; i <= count; ++i) {
            std::array<double, 2> next{infinite, infinite};
            for (const std::size_t from : both)
                for (const std::size_t to : both) {
                    const double d = length[from] + (whole.points[ends[i - 1][from]] -
                                                     whole.points[ends[i % count][to]])
                                                        .norm();
                    if (d < next[to]) {
                        next[to] = d;
                        before[i][to] = from;
                    }
                }
            length = next;
        }
        if (length[first] >= least)
            continue;
        least = length[first];
        best.resize(count);
        for (std::size_t i = count, end = first; i > 0; --i) {
            end = before[i][end];
            best[i - 1] = ends[i - 1][end];
        }
    }
    return best;
}

// The vertices of the whole that those of the half are or become.
std::vector<Index> places_of(const Mesh& whole, const Half& half) {
    std::vector<Index> place;
    for (const Ends& ends : half.ends)
        place.push_back(ends[0]);
    std::vector<std::uint8_t> is_done(half.mesh.twin.size(), 0);
    for (const HalfEdge start : half.mesh.all_half_edges()) {
        std::vector<Index> loop;
        std::vector<Ends> ends;
        for (HalfEdge h = start; half.mesh.twin[h] < 0 && is_done[h] == 0;
             h = half.mesh.next_on_boundary(h)) {
            is_done[h] = 1;
            loop.push_back(half.mesh.origin(h));
            ends.push_back(half.ends[half.mesh.origin(h)]);
        }
        if (loop.empty())
            continue;
        const std::vector<Index> chosen = shortest_loop(whole, ends);
        for (std::size_t i = 0; i < loop.size(); ++i)
            place[at(loop[i])] = chosen[i];
    }
    return place;
}

// Half-edge h of a face, on the mirror image of the face: it turns the other way.
HalfEdge mirrored(HalfEdge h, Index faces) {
    return half_edge_of(face_of(h) + faces, 2 - corner_of(h));
}

WorkingSurface glue(const Mesh& half, const MirrorPlane& plane) {
    const Index n = half.face_count();
    const auto is_seam = [&](HalfEdge h) {
        return half.twin[h] < 0 &&
               std::abs(plane.height(half.points[half.origin(h)])) < tuning.tiny &&
               std::abs(plane.height(half.points[half.target(h)])) < tuning.tiny;
    };
    std::vector<Index> other(half.points.size(), -1);
    for (const HalfEdge h : half.all_half_edges())
        if (is_seam(h))
            for (const Vertex v : {half.origin(h), half.target(h)})
                other[v] = v;
    WorkingSurface result;
    Mesh& mesh = result.mesh;
    mesh.points = half.points;
    mesh.unit_length = half.unit_length;
    for (std::size_t v = 0; v < other.size(); ++v)
        if (other[v] < 0) {
            other[v] = mesh.vertex_count();
            mesh.points.push_back(plane.reflect(half.points[v]));
        }
    mesh.faces = half.faces;
    for (const Triangle& t : half.faces)
        mesh.faces.push_back({other[t[0]], other[t[2]], other[t[1]]});
    mesh.twin.assign(at(6 * n), -1);
    result.image.assign(at(6 * n), -1);
    for (HalfEdge h = 0; h < 3 * n; ++h) {
        const HalfEdge image = mirrored(h, n);
        result.image[h] = image;
        result.image[image] = h;
        const HalfEdge twin = is_seam(h) ? image : half.twin[h];
        mesh.twin[h] = twin;
        if (twin >= 0)
            mesh.twin[image] = twin == image ? h : mirrored(twin, n);
    }
    mesh::compute_face_geometry(mesh);
    // To the last bit: what is measured on both sides must agree.
    for (Face f = 0; f < n; ++f)
        mesh.face_areas[f + n] = mesh.face_areas[f];
    result.side = plane;
    return result;
}

} // namespace

WorkingSurface plain_working_surface(const Mesh& mesh, Index most_faces, Progress& progress) {
    if (mesh.face_count() <= most_faces)
        return {mesh, {}};
    return {mesh::coarsen_in_parallel(mesh, most_faces, progress).mesh, {}};
}

std::optional<WorkingSurface> mirrored_working_surface(const Mesh& mesh, const MirrorPlane& plane,
                                                       Index most_faces, Index kept_faces,
                                                       const Progress& progress) {
    MirrorPlane turned = plane;
    turned.normal = -plane.normal;
    turned.offset = -plane.offset;
    std::optional<WorkingSurface> best;
    double least = infinite;
    for (const MirrorPlane& side : {plane, turned}) {
        progress.check();
        Mesh half = clean_half(Slicer(mesh, side).slice(), mesh.total_area).mesh;
        if (half.faces.empty())
            continue;
        const double area = 2.0 * half.total_area / mesh.total_area;
        if (std::abs(std::log(area)) >= least || area < tuning.whole_area ||
            area > 1.0 / tuning.whole_area)
            continue;
        if (2 * half.face_count() > kept_faces)
            half = mesh::coarsen(half, most_faces / 2, progress).mesh;
        WorkingSurface surface = glue(half, side);
        if (euler_characteristic(surface.mesh) != euler_characteristic(mesh))
            continue;
        least = std::abs(std::log(area));
        best = std::move(surface);
    }
    return best;
}

std::optional<MirroredModel> mirrored_model(const Mesh& mesh, const MirrorPlane& side) {
    const Half half = clean_half(Slicer(mesh, side).slice(), mesh.total_area);
    if (half.mesh.faces.empty())
        return std::nullopt;
    MirroredModel model{glue(half.mesh, side), places_of(mesh, half)};
    if (euler_characteristic(model.surface.mesh) != euler_characteristic(mesh))
        return std::nullopt;
    model.place.resize(model.surface.mesh.points.size(), -1);
    return model;
}

void mirror_marks(const WorkingSurface& surface, SeamMarks& marks) {
    for (std::size_t h = 0; h < surface.image.size() / 2; ++h)
        marks[surface.image[h]] = marks[h];
}

std::vector<std::vector<Index>> with_image(const WorkingSurface& surface,
                                           std::vector<std::vector<Index>> lines) {
    for (std::size_t i = 0, count = lines.size(); i < count && surface.is_symmetric(); ++i) {
        lines.push_back(lines[i]);
        for (Index& h : lines.back())
            h = surface.image[h];
    }
    return lines;
}

void mark_both(const WorkingSurface& surface, const std::vector<Index>& line, std::uint8_t value,
               SeamMarks& marks) {
    for (const HalfEdge h : line) {
        mark(surface.mesh, h, value, marks);
        if (surface.is_symmetric())
            mark(surface.mesh, surface.image[h], value, marks);
    }
}

} // namespace devseg::plush
