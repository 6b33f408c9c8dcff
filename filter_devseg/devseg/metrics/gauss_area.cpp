#include "devseg/metrics/gauss_area.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "devseg/mesh/angle_defects.h"

namespace devseg::metrics {

namespace {

// Rounding leaves areas of this size where all normals agree; as they are, they would decide
// between charts that are exactly developable.
constexpr double rounding_area = 1e-13; // steradians

double signed_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    return 2.0 * std::atan2(a.dot(b.cross(c)), 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
}

double absolute_area(const std::vector<Vec3>& corners) {
    const double area = std::abs(signed_spherical_area(corners));
    return area > rounding_area ? std::min(area, 4.0 * pi) : 0.0;
}

// The faces around a vertex as half-edges that leave it, counter-clockwise, beginning behind a
// crease where there is one.
struct Star {
    std::vector<HalfEdge> half_edges;
    bool closed = false;
};

void walk_star(const Mesh& mesh, HalfEdge first, const std::vector<std::uint8_t>& crease,
               Star& star) {
    star.half_edges.clear();
    star.closed = mesh::visit_star(mesh, first, [&](HalfEdge h) { star.half_edges.push_back(h); });
    if (star.closed)
        std::rotate(star.half_edges.begin(),
                    std::find_if(star.half_edges.begin(), star.half_edges.end(),
                                 [&](HalfEdge h) { return crease[h] != 0; }),
                    star.half_edges.end());
}

// A single crease that ends at a vertex does not split its fan: both its sides are one part.
Index count_parts(const Star& star, const std::vector<std::uint8_t>& crease) {
    Index parts = star.closed ? 0 : 1;
    for (std::size_t i = star.closed ? 0 : 1; i < star.half_edges.size(); ++i)
        parts += crease[star.half_edges[i]] != 0 ? 1 : 0;
    return std::max(parts, Index{1});
}

// The normal of a corner with the weight of [Max 1999]; zero where an edge has no length.
Vec3 weighted_normal(const Mesh& mesh, HalfEdge h) {
    const Vec3& corner = mesh.points[mesh.origin(h)];
    const Vec3 a = mesh.points[mesh.target(h)] - corner;
    const Vec3 b = mesh.points[mesh.origin(Mesh::previous(h))] - corner;
    const double scale = a.squaredNorm() * b.squaredNorm();
    return scale > 0.0 ? Vec3(a.cross(b) / scale) : Vec3::Zero();
}

Vec3 part_normal(const Mesh& mesh, const HalfEdge* begin, const HalfEdge* end) {
    Vec3 sum = Vec3::Zero();
    for (const HalfEdge* h = begin; h != end; ++h)
        sum += weighted_normal(mesh, *h);
    const double length = sum.norm();
    if (length > 0.0 && std::isfinite(length))
        return sum / length;
    return mesh.face_normals[face_of(*begin)]; // all weights vanish: any of the faces
}

// Calls visit(begin, end) for the smooth parts around a vertex.
template <class Visit>
void visit_parts(const Star& star, const std::vector<std::uint8_t>& crease, Visit visit) {
    const HalfEdge* const begin = star.half_edges.data();
    const HalfEdge* const end = begin + star.half_edges.size();
    if (count_parts(star, crease) == 1) {
        visit(begin, end);
        return;
    }
    for (const HalfEdge* from = begin; from != end;) {
        const HalfEdge* to = from + 1;
        while (to != end && crease[*to] == 0)
            ++to;
        visit(from, to);
        from = to;
    }
}

} // namespace

double signed_spherical_area(const std::vector<Vec3>& corners) {
    double sum = 0.0;
    for (std::size_t i = 2; i < corners.size(); ++i)
        sum += signed_triangle(corners[0], corners[i - 1], corners[i]);
    return sum;
}

std::vector<std::uint8_t> find_creases(const Mesh& mesh, double angle) {
    const double cosine = std::cos(angle);
    std::vector<std::uint8_t> crease(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge twin = mesh.twin[h];
        if (twin >= 0)
            crease[h] = mesh.face_normals[face_of(h)].dot(mesh.face_normals[face_of(twin)]) < cosine
                            ? 1
                            : 0;
    }
    return crease;
}

std::vector<Vec3> split_normals(const Mesh& mesh, const std::vector<std::uint8_t>& crease) {
    std::vector<Vec3> normals(mesh.twin.size(), Vec3::UnitZ());
    Star star;
    for (const HalfEdge first : mesh::leaving_half_edges(mesh)) {
        if (first < 0)
            continue;
        walk_star(mesh, first, crease, star);
        visit_parts(star, crease, [&](const HalfEdge* begin, const HalfEdge* end) {
            const Vec3 normal = part_normal(mesh, begin, end);
            for (const HalfEdge* h = begin; h != end; ++h)
                normals[*h] = normal;
        });
    }
    return normals;
}

std::vector<std::uint8_t> long_creases(const Mesh& mesh, const std::vector<std::uint8_t>& crease,
                                       Index charts) {
    const double length = 0.75 * std::sqrt(mesh.total_area / charts);
    std::vector<Index> root(mesh.points.size());
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](Vertex v) {
        while (root[v] != v)
            v = root[v] = root[root[v]];
        return v;
    };
    for (const HalfEdge h : mesh.all_half_edges())
        if (crease[h] != 0)
            root[find(mesh.origin(h))] = find(mesh.target(h));
    std::vector<double> chain(mesh.points.size(), 0.0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (crease[h] != 0)
            chain[find(mesh.origin(h))] += 0.5 * mesh.edge_length(h);
    std::vector<std::uint8_t> result(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        result[h] = crease[h] != 0 && chain[find(mesh.origin(h))] >= length ? 1 : 0;
    return result;
}

GaussAreas compute_gauss_areas(const Mesh& mesh, double crease_angle) {
    GaussAreas result;
    result.crease = find_creases(mesh, crease_angle);
    const std::vector<Vec3> normals = split_normals(mesh, result.crease);
    result.face.resize(mesh.faces.size());
    result.edge.assign(mesh.twin.size(), 0.0);
    result.vertex.assign(mesh.points.size(), 0.0);
    std::vector<Vec3> corners(3);
    for (const Face f : mesh.all_faces()) {
        corners.assign(normals.begin() + 3 * f, normals.begin() + 3 * f + 3);
        result.total += result.face[f] = absolute_area(corners);
    }
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge twin = mesh.twin[h];
        if (result.crease[h] == 0 || h > twin)
            continue;
        corners = {normals[h], normals[Mesh::next(h)], normals[twin], normals[Mesh::next(twin)]};
        result.total += result.edge[h] = result.edge[twin] = absolute_area(corners);
    }
    Star star;
    for (const HalfEdge first : mesh::leaving_half_edges(mesh)) {
        if (first < 0)
            continue;
        walk_star(mesh, first, result.crease, star);
        corners.clear();
        visit_parts(star, result.crease, [&](const HalfEdge* begin, const HalfEdge*) {
            corners.push_back(normals[*begin]);
        });
        if (star.closed)
            result.total += result.vertex[mesh.origin(first)] = absolute_area(corners);
    }
    return result;
}

std::vector<double> chart_gauss_areas(const Mesh& mesh, const GaussAreas& areas,
                                      const std::vector<Index>& chart, Index count) {
    std::vector<double> sums(at(count), 0.0);
    std::vector<std::uint8_t> shared(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index c = chart[face_of(h)];
        const HalfEdge twin = mesh.twin[h];
        if (twin >= 0 && chart[face_of(twin)] != c)
            shared[mesh.origin(h)] = shared[mesh.target(h)] = 1;
        else if (h < twin)
            sums[c] += areas.edge[h];
    }
    for (const Face f : mesh.all_faces())
        sums[chart[f]] += areas.face[f];
    const std::vector<Index> leaving = mesh::leaving_half_edges(mesh);
    for (const Vertex v : mesh.all_vertices())
        if (leaving[v] >= 0 && shared[v] == 0)
            sums[chart[face_of(leaving[v])]] += areas.vertex[v];
    return sums;
}

double standard_deviation(const std::vector<double>& values) {
    double mean = 0.0;
    for (const double v : values)
        mean += v / static_cast<double>(values.size());
    double variance = 0.0;
    for (const double v : values)
        variance += (v - mean) * (v - mean) / static_cast<double>(values.size());
    return std::sqrt(variance);
}

} // namespace devseg::metrics
