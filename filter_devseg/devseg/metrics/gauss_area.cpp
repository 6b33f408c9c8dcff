#include "devseg/metrics/gauss_area.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace devseg::metrics {

namespace {

constexpr double full_sphere = 4.0 * pi;

// Rounding leaves areas of this size where all normals agree; as they are, they would decide
// between charts that are exactly developable.
constexpr double rounding = 1e-13;

double signed_triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    return 2.0 * std::atan2(a.dot(b.cross(c)), 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
}

double absolute_area(const std::vector<Vec3>& corners) {
    const double area = std::abs(signed_spherical_area(corners));
    return area > rounding ? std::min(area, full_sphere) : 0.0;
}

// A half-edge that leaves each vertex; on the boundary the one from which visit_star goes around
// the whole fan without turning back.
std::vector<Index> first_half_edges(const Mesh& mesh) {
    std::vector<Index> first(mesh.points.size(), -1);
    for (const HalfEdge h : mesh.all_half_edges())
        if (first[mesh.origin(h)] < 0 || mesh.twin[h] < 0)
            first[mesh.origin(h)] = h;
    return first;
}

// The faces around a vertex as half-edges that leave it, counter-clockwise, beginning behind a
// crease where there is one.
struct Star {
    std::vector<Index> half_edges;
    bool closed = false;
};

void walk_star(const Mesh& mesh, Index first, const std::vector<std::uint8_t>& crease, Star& star) {
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

Vec3 part_normal(const Mesh& mesh, const Index* begin, const Index* end) {
    Vec3 sum = Vec3::Zero();
    for (const Index* h = begin; h != end; ++h)
        sum += weighted_normal(mesh, *h);
    const double length = sum.norm();
    if (length > 0.0 && std::isfinite(length))
        return sum / length;
    return mesh.face_normals[*begin / 3]; // all weights vanish: any of the faces
}

// Calls visit(begin, end) for the smooth parts around a vertex.
template <class Visit>
void visit_parts(const Star& star, const std::vector<std::uint8_t>& crease, Visit visit) {
    const Index* const begin = star.half_edges.data();
    const Index* const end = begin + star.half_edges.size();
    if (count_parts(star, crease) == 1) {
        visit(begin, end);
        return;
    }
    for (const Index* from = begin; from != end;) {
        const Index* to = from + 1;
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
            crease[h] = mesh.face_normals[h / 3].dot(mesh.face_normals[twin / 3]) < cosine ? 1 : 0;
    }
    return crease;
}

std::vector<Vec3> split_normals(const Mesh& mesh, const std::vector<std::uint8_t>& crease) {
    std::vector<Vec3> normals(mesh.twin.size(), Vec3::UnitZ());
    Star star;
    for (const Index first : first_half_edges(mesh)) {
        if (first < 0)
            continue;
        walk_star(mesh, first, crease, star);
        visit_parts(star, crease, [&](const Index* begin, const Index* end) {
            const Vec3 normal = part_normal(mesh, begin, end);
            for (const Index* h = begin; h != end; ++h)
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
    for (const Index first : first_half_edges(mesh)) {
        if (first < 0)
            continue;
        walk_star(mesh, first, result.crease, star);
        corners.clear();
        visit_parts(star, result.crease,
                    [&](const Index* begin, const Index*) { corners.push_back(normals[*begin]); });
        if (star.closed)
            result.total += result.vertex[mesh.origin(first)] = absolute_area(corners);
    }
    return result;
}

std::vector<double> chart_gauss_areas(const Mesh& mesh, const GaussAreas& areas,
                                      const std::vector<Index>& chart, Index count) {
    constexpr Index shared = -2;
    std::vector<double> sums(at(count), 0.0);
    std::vector<Index> owner(mesh.points.size(), -1);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index c = chart[h / 3];
        Index& first = owner[mesh.origin(h)];
        first = first == -1 || first == c ? c : shared;
        const HalfEdge twin = mesh.twin[h];
        if (h < twin && chart[twin / 3] == c)
            sums[c] += areas.edge[h];
    }
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
        sums[chart[f]] += areas.face[f];
    for (std::size_t v = 0; v < owner.size(); ++v)
        if (owner[v] >= 0)
            sums[owner[v]] += areas.vertex[v];
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
