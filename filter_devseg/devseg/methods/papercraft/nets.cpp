#include "devseg/methods/papercraft/nets.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>

#include <Eigen/Geometry>

#include "devseg/graph/unions.h"
#include "devseg/mesh/flat_regions.h"
#include "devseg/plane/overlap.h"
#include "devseg/plane/plane.h"

namespace devseg::papercraft {

namespace {

struct Tuning {
    // Of the root of the surface's area: sides of an edge that are closer lie on each other.
    double together = 1e-7;
    int most_orders = 200;
    Index most_faces_in_all = 60000; // over all orders, so that large surfaces try few
    double variation = 0.6;          // of the lengths that hinges are sorted by
};
constexpr Tuning tuning;

// A hinge between two faces of the polyhedron, by one of its half-edges.
struct Hinge {
    HalfEdge edge;
    double length;
};

// The faces in the plane: islands that grow together.
class Nets {
public:
    // `most_faces`: of a net, those of one plane being one; 0: no limit.
    Nets(const Mesh& mesh, const mesh::FaceComponents& regions, Index most_faces)
        : mesh_(mesh), regions_(regions), most_faces_(most_faces), islands_(at(regions.count)),
          faces_(at(regions.count)), size_(at(regions.count), 1) {
        uv_.resize(mesh.twin.size());
        lay_flat();
        tolerance_ = plane::layout_tolerance(std::sqrt(mesh.total_area));
        together_ = tuning.together * std::sqrt(mesh.total_area);
    }

    // Lays the smaller island beside the larger one, if there is room.
    void hinge(HalfEdge h) {
        HalfEdge fixed = h;
        HalfEdge moved = mesh_.twin[h];
        if (island(fixed) == island(moved))
            return;
        const Index size = size_[at(island(fixed))] + size_[at(island(moved))];
        if (most_faces_ > 0 && size > most_faces_)
            return;
        if (faces_[at(island(fixed))].size() < faces_[at(island(moved))].size())
            std::swap(fixed, moved);
        const Vec2 along = corner(fixed, 1) - corner(fixed, 0);
        const Vec2 own = corner(moved, 0) - corner(moved, 1);
        const double angle = plane::signed_angle(own, along);
        const Vec2 offset = 0.5 * (corner(fixed, 0) + corner(fixed, 1)) -
                            plane::turned(0.5 * (corner(moved, 0) + corner(moved, 1)),
                                          std::cos(angle), std::sin(angle));
        std::vector<Index>& stay = faces_[at(island(fixed))];
        std::vector<Index>& come = faces_[at(island(moved))];
        CornerUv corners;
        for (const Index f : come)
            for (Index k = 0; k < 3; ++k)
                corners.push_back(
                    offset + plane::turned(uv_[at(3 * f + k)], std::cos(angle), std::sin(angle)));
        if (has_no_room(stay, corners))
            return;
        std::size_t i = 0;
        for (const Index f : come)
            for (Index k = 0; k < 3; ++k)
                uv_[at(3 * f + k)] = corners[i++];
        const Index into = island(fixed);
        const Index from = island(moved);
        stay.insert(stay.end(), come.begin(), come.end());
        come.clear();
        size_[at(into)] = size;
        islands_.join(into, from);
    }

    Index count() const {
        return static_cast<Index>(
            std::count_if(faces_.begin(), faces_.end(), [](const auto& f) { return !f.empty(); }));
    }

    // 3 #F: all edges but those whose sides lie on each other.
    std::vector<std::uint8_t> cuts() {
        std::vector<std::uint8_t> seam(mesh_.twin.size(), 0);
        for (const HalfEdge h : mesh_.all_half_edges()) {
            const HalfEdge twin = mesh_.twin[h];
            if (twin < 0 || regions_.label[face_of(h)] == regions_.label[face_of(twin)])
                continue;
            seam[h] = island(h) == island(twin) &&
                              (corner(h, 0) - corner(twin, 1)).norm() <= together_ &&
                              (corner(h, 1) - corner(twin, 0)).norm() <= together_
                          ? 0
                          : 1;
        }
        return seam;
    }

private:
    // Each flat region in its own plane, where it is an island.
    void lay_flat() {
        std::vector<Face> largest(at(regions_.count));
        for (const Face f : mesh_.all_faces()) {
            Face& best = largest[at(regions_.label[f])];
            if (best < 0 || mesh_.face_areas[f] > mesh_.face_areas[best])
                best = f;
        }
        for (const Face f : mesh_.all_faces()) {
            const Index region = regions_.label[f];
            const Vec3& normal = mesh_.face_normals[largest[at(region)]];
            const Vec3 x = normal.unitOrthogonal();
            const Vec3 y = normal.cross(x);
            const Vec3& origin = mesh_.face_centers[largest[at(region)]];
            for (Index k = 0; k < 3; ++k) {
                const Vec3 p = mesh_.points[mesh_.faces[f][at(k)]] - origin;
                uv_[at(3 * f + k)] = Vec2(p.dot(x), p.dot(y));
            }
            faces_[at(region)].push_back(f);
        }
    }

    Index island(HalfEdge h) { return islands_.find(regions_.label[face_of(h)]); }
    // Of the half-edge: its start (0) or its end (1).
    const Vec2& corner(HalfEdge h, int end) const { return uv_[end == 0 ? h : Mesh::next(h)]; }

    // Whether faces at these corners would lie on faces of the island.
    bool has_no_room(const std::vector<Index>& island, const CornerUv& corners) const {
        const Eigen::AlignedBox2d box = plane::box_of(corners);
        CornerUv near = corners;
        for (const Index f : island) {
            const std::size_t c = at(3 * f);
            if (box.intersects(plane::box_of({uv_[c], uv_[c + 1], uv_[c + 2]})))
                near.insert(near.end(), {uv_[c], uv_[c + 1], uv_[c + 2]});
        }
        return near.size() > corners.size() && plane::any_overlap(near, tolerance_);
    }

    const Mesh& mesh_;
    const mesh::FaceComponents& regions_;
    Index most_faces_;
    graph::Unions islands_;                 // of regions
    std::vector<std::vector<Index>> faces_; // of each island
    std::vector<Index> size_;               // of each island, in regions
    CornerUv uv_;
    double tolerance_ = 0.0;
    double together_ = 0.0;
};

double length_of(const Mesh& mesh, const std::vector<std::uint8_t>& seam) {
    double length = 0.0;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] > h && seam[h] != 0)
            length += mesh.edge_length(h);
    return length;
}

std::vector<Hinge> hinges_between(const Mesh& mesh, const mesh::FaceComponents& regions) {
    std::vector<Hinge> hinges;
    for (const HalfEdge h : mesh.all_half_edges())
        if (mesh.twin[h] > h && regions.label[face_of(h)] != regions.label[mesh.across(h)])
            hinges.push_back({h, mesh.edge_length(h)});
    // So that what is drawn for each does not depend on the order of the faces.
    std::stable_sort(hinges.begin(), hinges.end(),
                     [](const Hinge& a, const Hinge& b) { return a.length > b.length; });
    return hinges;
}

// The longest ones first; but for the first order, lengths are varied.
void sort_hinges(int order, int random_seed, std::vector<Hinge>& hinges) {
    std::mt19937 random(static_cast<std::uint32_t>(random_seed * tuning.most_orders + order));
    std::vector<std::pair<double, Hinge>> keyed;
    for (const Hinge& hinge : hinges) {
        const double share = static_cast<double>(random()) / 4294967296.0;
        const double factor = order + random_seed == 0 ? 1.0 : 1.0 - tuning.variation * share;
        keyed.emplace_back(-factor * hinge.length, hinge);
    }
    std::stable_sort(keyed.begin(), keyed.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t i = 0; i < keyed.size(); ++i)
        hinges[i] = keyed[i].second;
}

} // namespace

atlas::ChartMap unfold_into_nets(const Mesh& mesh, const NetOptions& options,
                                 const Progress& progress) {
    const mesh::FaceComponents regions = mesh::flat_regions(mesh);
    const std::vector<Hinge> hinges = hinges_between(mesh, regions);
    const Index components = mesh::face_components(mesh, [](Index) { return true; }).count;
    const int orders =
        std::clamp(tuning.most_faces_in_all / mesh.face_count(), 1, tuning.most_orders);
    std::vector<std::uint8_t> best;
    std::pair<Index, double> least(0, infinite); // nets, length of the cuts
    Heartbeat beat(progress);
    for (int order = 0; order < orders; ++order) {
        std::vector<Hinge> sorted = hinges;
        sort_hinges(order, options.random_seed, sorted);
        Nets nets(mesh, regions, options.most_faces);
        for (const Hinge& hinge : sorted) {
            beat();
            nets.hinge(hinge.edge);
        }
        std::vector<std::uint8_t> seam = nets.cuts();
        const std::pair<Index, double> found(nets.count(), length_of(mesh, seam));
        if (best.empty() || found < least) {
            least = found;
            best = std::move(seam);
        }
        if (least.first == components && order == 0)
            break; // the plain order has the shortest cuts
    }
    const mesh::FaceComponents nets =
        mesh::face_components(mesh, [&](HalfEdge h) { return best[h] == 0; });
    return atlas::make_chart_map(mesh, nets.label, best, false);
}

} // namespace devseg::papercraft
