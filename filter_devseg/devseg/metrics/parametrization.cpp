#include "devseg/metrics/parametrization.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include <Eigen/LU>

#include "devseg/atlas/holes.h"
#include "devseg/metrics/segmentation.h"
#include "devseg/plane/overlap.h"
#include "devseg/plane/plane.h"

namespace devseg::metrics {

namespace {

struct Tuning {
    double shapeless = 1e-12;     // of the longest edge squared: a thinner face has no shape
    double collapsed_face = 1e-6; // of its area: a face that covers less has collapsed in the plane
    // Of the model's size: a chart that is narrower is a line, whose width in the plane is what
    // 32-bit coordinates give it, as at the gate.
    double line = 1e-6;
};
constexpr Tuning tuning;

bool has_area(const Mesh& mesh, Face f) {
    double longest = 0.0;
    for (const HalfEdge h : half_edges_of(f))
        longest = std::max(
            longest, (mesh.points[mesh.target(h)] - mesh.points[mesh.origin(h)]).squaredNorm());
    return mesh.face_areas[f] > tuning.shapeless * longest;
}

// Singular values of the affine map from the plane to the surface on one face, Γ first.
std::array<double, 2> singular_values(const Mesh& mesh, const CornerUv& uv, Face f) {
    const Vec3& corner = mesh.points[mesh.faces[f][0]];
    const Vec3 first = mesh.points[mesh.faces[f][1]] - corner;
    const Vec3 second = mesh.points[mesh.faces[f][2]] - corner;
    const double base = first.norm();
    const double x = second.dot(first) / base;
    const double y = 2.0 * mesh.face_areas[f] / base;
    Eigen::Matrix2d surface;
    surface << base, x, 0.0, y;
    Eigen::Matrix2d plane;
    plane.col(0) = uv[3 * f + 1] - uv[3 * f];
    plane.col(1) = uv[3 * f + 2] - uv[3 * f];
    const Eigen::Matrix2d j = surface * plane.inverse();
    const double e = std::hypot(j(0, 0) + j(1, 1), j(1, 0) - j(0, 1));
    const double g = std::hypot(j(0, 0) - j(1, 1), j(1, 0) + j(0, 1));
    const double large = 0.5 * (e + g);
    return {large, std::abs(j.determinant()) / large};
}

template <class Vec>
double angle_at(const Vec& corner, const Vec& p, const Vec& q) {
    const Vec a = p - corner;
    const Vec b = q - corner;
    const double dot = a.dot(b);
    const double sine = std::sqrt(std::max(0.0, a.squaredNorm() * b.squaredNorm() - dot * dot));
    return std::atan2(sine, dot);
}

double squared_angle_change(const Mesh& mesh, const CornerUv& uv, Face f) {
    const Triangle& t = mesh.faces[f];
    double sum = 0.0;
    for (Index k = 0; k < 3; ++k) {
        const Index n = (k + 1) % 3;
        const Index m = (k + 2) % 3;
        const double change = angle_at(uv[3 * f + k], uv[3 * f + n], uv[3 * f + m]) -
                              angle_at(mesh.points[t[k]], mesh.points[t[n]], mesh.points[t[m]]);
        sum += change * change;
    }
    return sum / 3.0;
}

struct ChartAreas {
    std::vector<double> surface; // of each chart
    std::vector<double> plane;   // sum of the absolute areas
    std::vector<double> balance; // sum of the signed areas: its sign is the chart's orientation
    std::vector<double> longest; // edge on the surface

    bool is_line(const Mesh& mesh, std::size_t c) const {
        return surface[c] <= tuning.line * std::sqrt(mesh.model_area()) * longest[c];
    }
};

ChartAreas sum_areas(const Mesh& mesh, const CornerUv& uv, const atlas::ChartMap& charts) {
    const std::size_t count = at(charts.count);
    const std::vector<double> none(count, 0.0);
    ChartAreas areas{none, none, none, none};
    for (const Face f : mesh.all_faces()) {
        const std::size_t c = at(charts.chart[f]);
        const double area = plane::uv_area(uv, f);
        areas.surface[c] += mesh.face_areas[f];
        areas.plane[c] += std::abs(area);
        areas.balance[c] += area;
        for (const HalfEdge h : half_edges_of(f))
            areas.longest[c] = std::max(areas.longest[c], mesh.edge_length(h));
    }
    return areas;
}

// Of all faces with an area on both sides that are not flipped.
class StrainSums {
public:
    StrainSums(const ChartAreas& areas)
        : scale_(std::accumulate(areas.plane.begin(), areas.plane.end(), 0.0) /
                 std::accumulate(areas.surface.begin(), areas.surface.end(), 0.0)) {}

    void add(const Mesh& mesh, const CornerUv& uv, Face f) {
        const auto [large, small] = singular_values(mesh, uv, f);
        const double unit = std::sqrt(scale_);
        strain_.push_back(std::max(large * unit - 1.0, 1.0 - small * unit));
        area_.push_back(mesh.face_areas[f]);
    }
    flatten::Strain measure() const {
        return strain_.empty() ? flatten::Strain() : flatten::measure_strain(strain_, area_);
    }

private:
    double scale_ = 1.0; // areas in the plane over those on the surface
    std::vector<double> strain_;
    std::vector<double> area_;
};

// Sums over faces, for the whole layout and for one chart.
struct Sums {
    double weight = 0.0;
    double stretch = 0.0;
    double energy = 0.0;
    double shear = 0.0;

    double l2_stretch() const { return weight > 0.0 ? std::sqrt(stretch / weight) : 0.0; }
};

// Adds one face with an area on both sides; `scale` is the chart's area ratio, surface to plane.
void add_face(const Mesh& mesh, const CornerUv& uv, Face f, double scale, bool flipped,
              ParametrizationMeasures& result, Sums& all, Sums& own, ChartMeasures& chart) {
    const double area = mesh.face_areas[f];
    const auto [large, small] = singular_values(mesh, uv, f);
    // Γ² and γ² after the chart's lengths in the plane are multiplied by √scale.
    const double large2 = large * large / scale;
    const double small2 = small * small / scale;
    const double shear = squared_angle_change(mesh, uv, f);
    for (Sums* sums : {&all, &own}) {
        sums->weight += area;
        sums->stretch += area * 0.5 * (large2 + small2);
        sums->energy += area * 0.25 * (large2 + small2 + 1.0 / large2 + 1.0 / small2);
        sums->shear += area * shear;
    }
    const double flat = std::abs(plane::uv_area(uv, f));
    result.max_area_change = std::max(result.max_area_change, std::abs(1.0 - flat * scale / area));
    if (flipped)
        return;
    result.linf_stretch = std::max(result.linf_stretch, std::sqrt(large2));
    const double extension = 1.0 / std::sqrt(small2) - 1.0;
    const double compression = 1.0 - 1.0 / std::sqrt(large2);
    if (chart.worst_face < 0 ||
        std::max(extension, compression) > std::max(chart.extension, chart.compression))
        chart.worst_face = f;
    chart.extension = std::max(chart.extension, extension);
    chart.compression = std::max(chart.compression, compression);
}

} // namespace

ParametrizationMeasures measure_parametrization(const Mesh& mesh, const CornerUv& uv) {
    const atlas::ChartMap charts = atlas::charts_from_uv(mesh, uv);
    const ChartAreas areas = sum_areas(mesh, uv, charts);
    ParametrizationMeasures result;
    result.charts_number = charts.count;
    result.charts.resize(at(charts.count));
    for (const atlas::ChartSurface& surface : atlas::extract_charts(mesh, charts))
        if (surface.is_disk())
            ++result.disk_charts_number;
        else if (atlas::is_sound(mesh, surface))
            ++result.holed_charts_number;

    StrainSums strains(areas);
    Sums all;
    std::vector<Sums> own(at(charts.count));
    double covered = 0.0;
    for (const Face f : mesh.all_faces()) {
        const std::size_t c = at(charts.chart[f]);
        const double sign = areas.balance[c] < 0.0 ? -1.0 : 1.0;
        const bool flipped =
            !(sign * plane::orientation(uv[3 * f], uv[3 * f + 1], uv[3 * f + 2]) > 0.0);
        result.flipped_faces_number += flipped ? 1 : 0;
        const double scale = areas.plane[c] > 0.0 ? areas.surface[c] / areas.plane[c] : 0.0;
        const double flat = std::abs(plane::uv_area(uv, f));
        covered += flat;
        if (!areas.is_line(mesh, c) && has_area(mesh, f) &&
            flat * scale > tuning.collapsed_face * mesh.face_areas[f]) {
            add_face(mesh, uv, f, scale, flipped, result, all, own[c], result.charts[c]);
            if (!flipped)
                strains.add(mesh, uv, f);
        }
    }
    result.strain = strains.measure();
    result.l2_stretch = all.l2_stretch();
    if (all.weight > 0.0) {
        result.symmetric_dirichlet_energy = all.energy / all.weight;
        result.l2_shear = std::sqrt(all.shear / all.weight);
    }
    for (std::size_t c = 0; c < result.charts.size(); ++c) {
        result.charts[c].area = areas.surface[c] * mesh.unit_length * mesh.unit_length;
        result.charts[c].l2_stretch = own[c].l2_stretch();
    }
    for (const std::uint8_t overlapping : plane::find_overlapping_faces(uv))
        result.overlapping_faces_number += overlapping;
    result.seam_length = seam_length(mesh, charts);
    result.seams = measure_seams(mesh, charts, uv);
    const double box = plane::box_of(uv).sizes().prod();
    result.packing_efficiency = box > 0.0 ? covered / box : 0.0;
    return result;
}

std::vector<SeamMeasures> measure_seams(const Mesh& mesh, const atlas::ChartMap& charts,
                                        const CornerUv& uv) {
    const atlas::EvenLayout even = atlas::even_layout(mesh, charts, uv);
    const double scale = even.scale * mesh.unit_length;
    const auto flat_length = [&](HalfEdge h) {
        return scale * (even.uv[Mesh::next(h)] - even.uv[h]).norm();
    };
    std::map<std::pair<Index, Index>, SeamMeasures> seams;
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge twin = mesh.twin[h];
        if (charts.seam[h] == 0 || h > twin)
            continue;
        const auto chart_of = [&](HalfEdge side) { return charts.chart[face_of(side)]; };
        HalfEdge a = h; // the side in the chart with the lower number
        HalfEdge b = twin;
        if (chart_of(a) > chart_of(b))
            std::swap(a, b);
        const std::pair<Index, Index> key(chart_of(a), chart_of(b));
        SeamMeasures& seam = seams[key];
        seam.chart_a = key.first;
        seam.chart_b = key.second;
        seam.surface_length += mesh.edge_length(h) * mesh.unit_length;
        seam.length_a += flat_length(a);
        seam.length_b += flat_length(b);
    }
    std::vector<SeamMeasures> result;
    for (const auto& [key, seam] : seams)
        result.push_back(seam);
    return result;
}

} // namespace devseg::metrics
