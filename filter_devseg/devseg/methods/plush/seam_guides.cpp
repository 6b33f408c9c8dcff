#include "devseg/methods/plush/seam_guides.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "devseg/mesh/flat_regions.h"
#include "devseg/methods/plush/tuning.h"

namespace devseg::plush {

namespace {

double smooth_step(double from, double to, double x) {
    const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

// Mean normals beside edges.
class EdgeShapes {
public:
    explicit EdgeShapes(const Mesh& mesh)
        : mesh_(mesh), reach_(tuning.beside_edge * mesh.diagonal()), seen_(mesh.faces.size(), -1) {}

    EdgeShape at_edge(HalfEdge h) {
        const HalfEdge twin = mesh_.twin[h];
        const Side left = side_of(h);
        if (twin < 0)
            return {0.0, left.normal};
        const Side right = side_of(twin);
        const Vec3 edge =
            (mesh_.points[mesh_.target(h)] - mesh_.points[mesh_.origin(h)]).normalized();
        const double angle =
            std::atan2(left.normal.cross(right.normal).dot(edge), left.normal.dot(right.normal));
        // Large faces see more of a curved surface.
        const double bend = angle * std::min(1.0, reach_ / (right.center - left.center).norm());
        return {bend, (left.normal + right.normal).stableNormalized()};
    }

private:
    struct Side {
        Vec3 normal;
        Vec3 center;
    };

    // Of the faces that hang together with the half-edge's own on its side and are near.
    Side side_of(HalfEdge h) {
        const Vec3& a = mesh_.points[mesh_.origin(h)];
        const Vec3& b = mesh_.points[mesh_.target(h)];
        const Vec3 middle = 0.5 * (a + b);
        const Vec3 inward = mesh_.face_normals[face_of(h)].cross(b - a);
        std::vector<Index> faces{face_of(h)};
        seen_[face_of(h)] = h;
        Vec3 normal = Vec3::Zero();
        Vec3 center = Vec3::Zero();
        double area = 0.0;
        for (std::size_t k = 0; k < faces.size(); ++k) {
            normal += mesh_.face_areas[faces[k]] * mesh_.face_normals[faces[k]];
            center += mesh_.face_areas[faces[k]] * mesh_.face_centers[faces[k]];
            area += mesh_.face_areas[faces[k]];
            for (const HalfEdge e : half_edges_of(faces[k])) {
                const HalfEdge twin = mesh_.twin[e];
                if (e == h || twin < 0 || seen_[face_of(twin)] == h)
                    continue;
                const Vec3 away = mesh_.face_centers[face_of(twin)] - middle;
                if (away.norm() > reach_ || away.dot(inward) <= 0.0)
                    continue;
                seen_[face_of(twin)] = h;
                faces.push_back(face_of(twin));
            }
        }
        return {normal.stableNormalized(), center / std::max(area, 1e-300)};
    }

    const Mesh& mesh_;
    const double reach_;
    std::vector<Index> seen_; // #F: the half-edge that asked last
};

// The direction of a seam at each of its edges: between the points half a window before and behind.
std::vector<Vec3> smooth_directions(const Mesh& mesh, const SeamSegment& segment, double width) {
    std::vector<Vec3> point{mesh.points[mesh.origin(segment.half_edges.front())]};
    std::vector<double> place{0.0};
    for (const HalfEdge h : segment.half_edges) {
        point.push_back(mesh.points[mesh.target(h)]);
        place.push_back(place.back() + mesh.edge_length(h));
    }
    const auto point_at = [&](double s) {
        const auto next = std::upper_bound(place.begin() + 1, place.end() - 1, s);
        const auto i = static_cast<std::size_t>(next - place.begin());
        const double t = (s - place[i - 1]) / std::max(place[i] - place[i - 1], 1e-300);
        return Vec3(point[i - 1] + t * (point[i] - point[i - 1]));
    };
    std::vector<Vec3> directions;
    for (std::size_t i = 0; i + 1 < place.size(); ++i) {
        const double middle = 0.5 * (place[i] + place[i + 1]);
        const Vec3 chord = point_at(std::min(place.back(), middle + 0.5 * width)) -
                           point_at(std::max(0.0, middle - 0.5 * width));
        directions.push_back(chord.stableNormalized());
    }
    return directions;
}

struct Sample {
    Vec3 point;
    double length = 0.0;
};

std::vector<Sample> sample_seams(const Mesh& mesh, const SeamMarks& seam, double distance) {
    std::vector<Sample> samples;
    for (const HalfEdge h : mesh.all_half_edges()) {
        if (seam[h] == 0 || mesh.twin[h] < h)
            continue;
        const Vec3& a = mesh.points[mesh.origin(h)];
        const Vec3& b = mesh.points[mesh.target(h)];
        const int count = std::max(1, static_cast<int>(std::ceil((b - a).norm() / distance)));
        for (int k = 0; k < count; ++k)
            samples.push_back({a + (k + 0.5) / count * (b - a), (b - a).norm() / count});
    }
    return samples;
}

double mirrored_share(const std::vector<Sample>& samples, const MirrorPlane& plane, double reach,
                      const Progress& progress) {
    double mirrored = 0.0;
    double total = 0.0;
    for (const Sample& sample : samples) {
        progress.check();
        const Vec3 image = plane.reflect(sample.point);
        total += sample.length;
        const bool has_image = std::any_of(samples.begin(), samples.end(), [&](const Sample& s) {
            return (s.point - image).squaredNorm() < reach * reach;
        });
        mirrored += has_image ? sample.length : 0.0;
    }
    return total > 0.0 ? mirrored / total : 0.0;
}

bool is_along_border(const Vec3& middle, const Vec3& direction,
                     const std::vector<SeamGuides::Line>& borders, double reach) {
    return std::any_of(borders.begin(), borders.end(), [&](const SeamGuides::Line& line) {
        const Vec3 edge = line.to - line.from;
        return squared_distance(middle, line.from, line.to) < reach * reach &&
               std::abs(edge.dot(direction)) >= std::cos(tuning.aligned) * edge.norm();
    });
}

} // namespace

std::vector<EdgeShape> edge_shapes(const Mesh& mesh, const Progress& progress) {
    EdgeShapes shapes(mesh);
    std::vector<EdgeShape> result(mesh.twin.size());
    for (const HalfEdge h : mesh.all_half_edges()) {
        if (h % 1024 == 0)
            progress.check();
        const HalfEdge twin = mesh.twin[h];
        if (twin < h)
            result[h] = shapes.at_edge(h);
        if (twin >= 0 && twin < h)
            result[twin] = result[h];
    }
    return result;
}

double straying(double across, double bend) {
    const double bent =
        std::max(smooth_step(0.5 * tuning.aligned, tuning.aligned, bend),
                 smooth_step(0.25 * tuning.aligned / 3.0, tuning.aligned / 3.0, -bend));
    return std::min(
        smooth_step(1.0 - std::cos(20.0 * degrees), 1.0 - std::cos(50.0 * degrees), across),
        1.0 - bent);
}

SeamWeights seam_weights(const Mesh& mesh, const SeamWeightOptions& options,
                         const std::vector<double>& curvature, const Skeleton& skeleton,
                         const BoneWeights& bones, const Progress& progress) {
    const std::vector<EdgeShape> shapes = edge_shapes(mesh, progress);
    double longest = 0.0;
    for (const HalfEdge h : mesh.all_half_edges())
        longest = std::max(longest, mesh.edge_length(h));
    const std::vector<std::uint8_t> within_flat =
        mesh::within_flat_regions(mesh, tuning.flat_region);
    SeamWeights result;
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index a = std::min(mesh.origin(h), mesh.target(h));
        const Index b = std::max(mesh.origin(h), mesh.target(h));
        double along = 1.0;
        if (!skeleton.empty()) {
            const Vec3& normal = shapes[h].normal;
            const SkeletonDirection bone = skeleton_direction(skeleton, bones, a, b, normal);
            const Vec3 edge = mesh.points[b] - mesh.points[a];
            const Vec3 lying = (edge - edge.dot(normal) * normal).stableNormalized();
            along = 1.0 - bone.agreement * std::abs(lying.dot(bone.direction));
        }
        const double curved = 1.0 / (1.0 + std::abs(curvature[a]) + std::abs(curvature[b]));
        result.stray.push_back(straying(along, shapes[h].bend));
        result.weight.push_back((within_flat[h] != 0 ? tuning.through_flat : 1.0) *
                                natural_factor(tuning.natural_seam, result.stray.back()) *
                                std::max(tuning.least_path_weight,
                                         std::pow(mesh.edge_length(h) / longest, options.geodesic) *
                                             std::pow(std::max(0.0, along), options.skeleton) *
                                             std::pow(curved, options.curvature)));
    }
    return result;
}

std::vector<double> natural_lengths(const Mesh& mesh, const std::vector<double>& stray,
                                    double share) {
    std::vector<double> lengths = edge_lengths(mesh);
    for (std::size_t h = 0; h < lengths.size(); ++h)
        lengths[h] *= natural_factor(share, stray[h]);
    return lengths;
}

SeamShares seam_shares(const Mesh& mesh, const SeamMarks& seam, const SeamGuides& guides,
                       const std::optional<MirrorPlane>& plane, const Progress& progress) {
    const double diagonal = mesh.diagonal();
    const Skeleton& skeleton = guides.skeleton;
    BoneWeights bones;
    if (!skeleton.empty())
        bones = bone_weights(mesh, make_laplacian(mesh), skeleton, progress);
    EdgeShapes shapes(mesh);
    double guided = 0.0;
    double total = 0.0;
    const auto is_guided = [&](HalfEdge h, const Vec3& direction) {
        const Index a = mesh.origin(h);
        const Index b = mesh.target(h);
        const EdgeShape shape = shapes.at_edge(h);
        if (shape.bend >= tuning.aligned || shape.bend <= -tuning.aligned / 3.0)
            return true;
        const Vec3 lying = direction - direction.dot(shape.normal) * shape.normal;
        if (!skeleton.empty() &&
            std::abs(skeleton_direction(skeleton, bones, a, b, shape.normal)
                         .direction.dot(lying.stableNormalized())) >= std::cos(tuning.aligned))
            return true;
        return is_along_border(0.5 * (mesh.points[a] + mesh.points[b]), direction,
                               guides.limb_borders, tuning.beside_edge * diagonal);
    };
    for (const SeamSegment& segment : find_segments(mesh, seam)) {
        const std::vector<Vec3> direction =
            smooth_directions(mesh, segment, 2.0 * tuning.near_image * diagonal);
        for (std::size_t i = 0; i < direction.size(); ++i) {
            progress.check();
            const HalfEdge h = segment.half_edges[i];
            total += mesh.edge_length(h);
            if (is_guided(h, direction[i]))
                guided += mesh.edge_length(h);
        }
    }
    SeamShares result;
    result.guided = total > 0.0 ? guided / total : 1.0;
    if (plane)
        result.mirrored =
            mirrored_share(sample_seams(mesh, seam, tuning.near_image / 4.0 * diagonal), *plane,
                           tuning.near_image * diagonal, progress);
    return result;
}

} // namespace devseg::plush
