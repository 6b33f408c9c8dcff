#include "devseg/atlas/texture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace devseg::atlas {

namespace {

// Charts whose boundary lengths agree to this share were flattened to keep them. Coordinates of 32
// bit change the length of a short boundary by about a tenth of that.
constexpr double same_edge = 1e-4;
// Charts are at one scale where the areas or boundaries of all are true to this share: flattenings
// keep one of them up to rounding, atlases for painting differ by factors.
constexpr double same_scale = 0.01;
// Charts that cover less of their own area have collapsed, and have no scale.
constexpr double collapsed = 1e-6;
// Regions of a chart that are turned over are charts of their own from this share of its area on:
// flattenings that fold turn over specks, atlases that mirror on purpose halves.
constexpr double mirrored_share = 0.05;

// Parts of each chart that are turned over, or not, as one label for each face: regions of one
// orientation, small ones as part of what they lie beside. Both have seams between them.
class MirroredParts {
public:
    MirroredParts(const Mesh& mesh, const CornerUv& uv, const ChartMap& charts)
        : mesh_(mesh), charts_(charts), turned_(mesh.faces.size(), 0) {
        for (const Face f : mesh.all_faces()) {
            area_.push_back(std::abs(plane::uv_area(uv, f)));
            turned_[f] = plane::uv_area(uv, f) < 0.0 ? 1 : 0;
        }
    }

    // Whether any chart has parts of both kinds; their borders are added to `seam`.
    bool mark(std::vector<std::uint8_t>& seam) {
        spread_to_small_regions();
        bool any = false;
        for (const HalfEdge h : mesh_.all_half_edges())
            if (is_inside(h) && turned_[face_of(h)] != turned_[mesh_.across(h)]) {
                seam[h] = 1;
                any = true;
            }
        return any;
    }

private:
    const Mesh& mesh_;
    const ChartMap& charts_;
    std::vector<double> area_;         // #F, in the plane
    std::vector<std::uint8_t> turned_; // #F

    bool is_inside(HalfEdge h) const { return mesh_.twin[h] >= 0 && charts_.seam[h] == 0; }

    // Small regions take the orientation of the large one that reaches them first.
    void spread_to_small_regions() {
        const mesh::FaceComponents regions = mesh::face_components(mesh_, [&](HalfEdge h) {
            return is_inside(h) && turned_[face_of(h)] == turned_[mesh_.across(h)];
        });
        std::vector<double> of_region(at(regions.count), 0.0);
        std::vector<double> of_chart(at(charts_.count), 0.0);
        for (const Face f : mesh_.all_faces()) {
            of_region[regions.label[f]] += area_[f];
            of_chart[charts_.chart[f]] += area_[f];
        }
        std::vector<Face> front;
        std::vector<std::uint8_t> done(mesh_.faces.size(), 0);
        for (const Face f : mesh_.all_faces())
            if (of_region[regions.label[f]] >= mirrored_share * of_chart[charts_.chart[f]]) {
                front.push_back(f);
                done[f] = 1;
            }
        for (std::size_t i = 0; i < front.size(); ++i)
            for (const HalfEdge h : half_edges_of(front[i])) {
                const Face g = mesh_.across(h);
                if (!is_inside(h) || done[g] != 0)
                    continue;
                done[g] = 1;
                turned_[g] = turned_[front[i]];
                front.push_back(g);
            }
    }
};

// What charts measure on the surface and in the plane, by their labels.
struct ChartSizes {
    std::vector<double> surface; // areas
    std::vector<double> plane;
    std::vector<double> surface_length; // of boundaries
    std::vector<double> plane_length;

    ChartSizes(const Mesh& mesh, const ChartMap& charts, const CornerUv& uv)
        : surface(at(charts.count), 0.0), plane(surface), surface_length(surface),
          plane_length(surface) {
        for (const Face f : mesh.all_faces()) {
            surface[charts.chart[f]] += mesh.face_areas[f];
            plane[charts.chart[f]] += std::abs(plane::uv_area(uv, f));
        }
        for (const HalfEdge h : mesh.all_half_edges())
            if (mesh.twin[h] < 0 || charts.seam[h] != 0) {
                surface_length[charts.chart[face_of(h)]] += mesh.edge_length(h);
                plane_length[charts.chart[face_of(h)]] += (uv[Mesh::next(h)] - uv[h]).norm();
            }
    }

    // That of the boundaries where all agree, or that of the areas.
    double scale() const {
        double least = infinite;
        double most = 0.0;
        for (std::size_t c = 0; c < surface.size(); ++c) {
            const double own = plane_length[c] > 0.0 ? surface_length[c] / plane_length[c] : 0.0;
            least = std::min(least, own);
            most = std::max(most, own);
        }
        const auto sum = [](const std::vector<double>& values) {
            return std::accumulate(values.begin(), values.end(), 0.0);
        };
        if (least > 0.0 && most <= (1.0 + same_edge) * least)
            return sum(surface_length) / sum(plane_length);
        return sum(plane) > 0.0 ? std::sqrt(sum(surface) / sum(plane)) : 0.0;
    }

    // The chart's own scale by its area; 0 where it has none.
    double own_scale(std::size_t c, double common) const {
        const bool has_area = plane[c] * common * common > collapsed * surface[c];
        return has_area && surface[c] > 0.0 ? std::sqrt(surface[c] / plane[c]) : 0.0;
    }

    // Whether area or boundary are true at this scale, up to the rounding of coordinates.
    bool is_true(std::size_t c, double scale, double rounding) const {
        const double wanted = surface[c] / (scale * scale);
        const double length = surface_length[c] / scale;
        return own_scale(c, scale) == 0.0 ||
               std::abs(plane[c] - wanted) <=
                   2.0 * same_scale * wanted + rounding * plane_length[c] ||
               std::abs(plane_length[c] - length) <= same_scale * length;
    }
};

} // namespace

ChartMap charts_from_uv(const Mesh& mesh, const CornerUv& uv, double tolerance) {
    const double apart = tolerance * plane::box_of(uv).diagonal().norm();
    const auto differ = [&](Index a, Index b) {
        return !((uv[a] - uv[b]).cwiseAbs().maxCoeff() <= apart);
    };
    std::vector<std::uint8_t> seam(mesh.twin.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const HalfEdge opposite = mesh.twin[h];
        if (opposite >= 0)
            seam[h] = differ(h, Mesh::next(opposite)) || differ(Mesh::next(h), opposite) ? 1 : 0;
    }
    const std::vector<Index> one(mesh.faces.size(), 0);
    ChartMap charts = make_chart_map(mesh, one, seam, true);
    if (MirroredParts(mesh, uv, charts).mark(seam))
        charts = make_chart_map(mesh, one, seam, true);
    return charts;
}

EvenLayout even_layout(const Mesh& mesh, const ChartMap& charts, const CornerUv& uv) {
    const ChartSizes sizes(mesh, charts, uv);
    EvenLayout even{uv, sizes.scale(), true};
    double largest = 0.0;
    for (const Vec2& p : uv)
        largest = std::max(largest, p.cwiseAbs().maxCoeff());
    const double rounding = std::numeric_limits<float>::epsilon() * largest;
    for (std::size_t c = 0; c < sizes.surface.size() && even.scale > 0.0; ++c)
        even.is_as_given = even.is_as_given && sizes.is_true(c, even.scale, rounding);
    if (even.is_as_given)
        return even;
    const Buckets<Index> faces = group_faces(charts);
    for (Index c = 0; c < charts.count; ++c) {
        const double own = sizes.own_scale(at(c), even.scale);
        if (own == 0.0)
            continue;
        Eigen::AlignedBox2d box;
        for (const Face f : faces[c])
            for (const HalfEdge h : half_edges_of(f))
                box.extend(uv[h]);
        for (const Face f : faces[c])
            for (const HalfEdge h : half_edges_of(f))
                even.uv[h] = box.center() + own / even.scale * (uv[h] - box.center());
    }
    return even;
}

std::vector<Vec2> read_map(const ChartSurface& surface, const CornerUv& uv, const Vec2& scale) {
    std::vector<Vec2> map(surface.vertex.size());
    for (const HalfEdge h : surface.all_half_edges())
        map[surface.origin(h)] = scale.cwiseProduct(uv[surface.mesh_half_edge(h)]);
    return map;
}

} // namespace devseg::atlas
