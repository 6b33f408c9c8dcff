#include "devseg/pattern/cloth_strain.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>

#include "devseg/pattern/shapes.h"
#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

struct Tuning {
    int directions = 36;          // of the grain that are tried, and of lines: every 5 degrees
    double least_limit = 1e-6;    // what coordinates of 32 bits leave of a limit of 0
    double most_of_it = 0.99;     // of the area, for the limits
    double reported_share = 0.95; // of the area, for people
    double anywhere = 2.0;        // limits hold so many times over on single faces
    double no_direction = 0.05;   // of its largest length, a mean of directions is none
    double equal_use = 1e-3;      // differences of this size are none
};
constexpr Tuning tuning;

double length_along(const FaceMetric& face, const Vec2& d) {
    return std::sqrt(std::max(0.0, face.xx * d.x() * d.x() + 2.0 * face.xy * d.x() * d.y() +
                                       face.yy * d.y() * d.y()));
}

Vec2 direction_at(double angle) {
    return {std::cos(angle), std::sin(angle)};
}

double use_of(double length, double stretch_limit, double compression) {
    const double strain = length - 1.0;
    return strain > 0.0 ? strain / std::max(stretch_limit, tuning.least_limit)
                        : -strain / std::max(compression, tuning.least_limit);
}

// What a share of the weight keeps. `values` and their weights.
double share_of(std::vector<std::pair<double, double>> values, double share) {
    std::sort(values.begin(), values.end());
    double total = 0.0;
    for (const auto& [value, weight] : values)
        total += weight;
    double sum = 0.0;
    for (const auto& [value, weight] : values) {
        sum += weight;
        if (sum >= share * total)
            return value;
    }
    return values.empty() ? 0.0 : values.back().first;
}

// The lines every 5 degrees, and the longest and the shortest one. Negative where the line that
// needs most is shorter on the model.
double signed_use(const FaceMetric& face, double grain, const material::Material& material) {
    double use = 0.0;
    const auto look = [&](double angle) {
        const double length = length_along(face, direction_at(angle));
        const double own =
            use_of(length, material.stretch_limit(angle - grain), material.compression);
        if (own > std::abs(use))
            use = length < 1.0 ? -own : own;
    };
    for (int i = 0; i < tuning.directions; ++i)
        look(grain + pi * i / tuning.directions);
    const double longest = 0.5 * std::atan2(2.0 * face.xy, face.xx - face.yy);
    look(longest);
    look(longest + 0.5 * pi);
    return use;
}

double largest_use(const FaceMetric& face, double grain, const material::Material& material) {
    return std::abs(signed_use(face, grain, material));
}

// Limits for both: most of the area, and any face.
double decisive(double most_of_it, double worst) {
    return std::max(most_of_it, worst / tuning.anywhere);
}

double need_of(const std::vector<FaceMetric>& faces, double grain,
               const material::Material& material) {
    std::vector<std::pair<double, double>> uses;
    double worst = 0.0;
    for (const FaceMetric& face : faces) {
        uses.emplace_back(largest_use(face, grain, material), face.weight);
        worst = std::max(worst, uses.back().first);
    }
    return decisive(share_of(std::move(uses), tuning.most_of_it), worst);
}

Vec2 upwards(Vec2 direction) {
    const bool is_down = direction.y() < 0.0 || (direction.y() == 0.0 && direction.x() < 0.0);
    return is_down ? Vec2(-direction) : direction;
}

Vec2 best_grain(const std::vector<FaceMetric>& faces, const material::Material& material,
                const Vec2& longest) {
    const double first = std::atan2(longest.y(), longest.x());
    double least = need_of(faces, first, material);
    double best = first;
    for (int i = 1; i < tuning.directions; ++i) {
        const double angle = first + pi * i / tuning.directions;
        const double need = need_of(faces, angle, material);
        if (need < least * (1.0 - tuning.equal_use)) {
            least = need;
            best = angle;
        }
    }
    return best == first ? longest : upwards(direction_at(best));
}

Vec2 upright_grain(const std::vector<FaceMetric>& faces, const Vec2& longest) {
    Vec2 sum = Vec2::Zero();
    double weights = 0.0;
    for (const FaceMetric& face : faces) {
        sum += face.weight * face.up;
        weights += face.weight;
    }
    return sum.norm() > tuning.no_direction * weights ? Vec2(sum.normalized()) : longest;
}

} // namespace

std::vector<FaceMetric> face_metrics(const Mesh& mesh, const std::vector<Vec2>& paper,
                                     const std::vector<Index>& faces, double mm) {
    std::vector<FaceMetric> metrics;
    for (const Face f : faces) {
        const Triangle& t = mesh.faces[f];
        Eigen::Matrix2d flat;
        flat << paper[3 * f + 1] - paper[3 * f], paper[3 * f + 2] - paper[3 * f];
        Eigen::Matrix<double, 3, 2> edges;
        edges << mm * (mesh.points[t[1]] - mesh.points[t[0]]),
            mm * (mesh.points[t[2]] - mesh.points[t[0]]);
        const double size = std::max(flat.squaredNorm(), edges.squaredNorm());
        if (!(std::abs(flat.determinant()) > vanishing * size) ||
            !(edges.col(0).cross(edges.col(1)).norm() > vanishing * size))
            continue;
        const Eigen::Matrix<double, 3, 2> map = edges * flat.inverse();
        const Eigen::Matrix2d metric = map.transpose() * map;
        FaceMetric face{metric(0, 0), metric(0, 1), metric(1, 1), mesh.face_areas[f], f, {}};
        face.up = metric.inverse() * map.transpose() * Vec3::UnitY();
        metrics.push_back(face);
    }
    return metrics;
}

ClothStrain measure_cloth(const std::vector<FaceMetric>& faces, const Vec2& grain,
                          const material::Material& material) {
    ClothStrain strain;
    std::vector<std::pair<double, double>> along;
    std::vector<std::pair<double, double>> across;
    std::vector<std::pair<double, double>> uses;
    const double angle = std::atan2(grain.y(), grain.x());
    for (const FaceMetric& face : faces) {
        along.emplace_back(std::abs(length_along(face, grain) - 1.0), face.weight);
        across.emplace_back(std::abs(length_along(face, plane::left_of(grain)) - 1.0), face.weight);
        strain.along = std::max(strain.along, along.back().first);
        strain.across = std::max(strain.across, across.back().first);
        uses.emplace_back(largest_use(face, angle, material), face.weight);
        if (uses.back().first > strain.worst_use || strain.worst_face < 0) {
            strain.worst_use = uses.back().first;
            strain.worst_face = face.face;
        }
    }
    strain.along_95 = share_of(std::move(along), tuning.reported_share);
    strain.across_95 = share_of(std::move(across), tuning.reported_share);
    strain.use_99 = share_of(std::move(uses), tuning.most_of_it);
    strain.is_within = decisive(strain.use_99, strain.worst_use) <= 1.0;
    return strain;
}

std::vector<double> limit_uses(const Pattern& pattern, double mm) {
    std::vector<double> uses(pattern.mesh.faces.size(), 0.0);
    std::vector<Index> faces;
    for (const Face f : pattern.mesh.all_faces())
        if (pattern.face_piece[f] >= 0)
            faces.push_back(f);
    for (const FaceMetric& face : face_metrics(pattern.mesh, pattern.corner_place, faces, mm)) {
        const Vec2& grain = pattern.pieces[at(pattern.face_piece[at(face.face)])].grain_direction;
        uses[at(face.face)] = signed_use(face, std::atan2(grain.y(), grain.x()), *pattern.material);
    }
    return uses;
}

Vec2 choose_grain(const std::vector<FaceMetric>& faces, const PatternOptions& options,
                  const material::Material* material, const Vec2& longest) {
    switch (options.grain) {
    case GrainDirection::longest:
        return longest;
    case GrainDirection::texture_v:
        return Vec2::UnitY();
    case GrainDirection::up:
        return upright_grain(faces, longest);
    case GrainDirection::angle:
        return direction_at(0.5 * pi + options.grain_angle * degrees);
    case GrainDirection::best:
    case GrainDirection::free:
        break;
    }
    const bool is_even = material == nullptr ||
                         (material->warp == material->weft && material->weft == material->bias);
    return is_even || faces.empty() ? longest : best_grain(faces, *material, longest);
}

void set_cloth(const Mesh& mesh, const std::vector<Index>& faces, const PatternOptions& options,
               double mm, const Pattern& pattern, PatternPiece& piece) {
    const PieceBox box = set_sizes(piece);
    const material::Material* material = pattern.material ? &*pattern.material : nullptr;
    const std::vector<FaceMetric> metrics = face_metrics(mesh, pattern.corner_place, faces, mm);
    const Vec2 grain = choose_grain(metrics, options, material, box.direction);
    set_grain(piece, grain);
    piece.grain_direction = grain;
    if (material == nullptr)
        return;
    piece.cloth = measure_cloth(metrics, grain, *material);
    if (const Index worst = piece.cloth.worst_face; worst >= 0)
        for (std::size_t k = 0; k < 3; ++k)
            piece.cloth.worst_place += pattern.corner_place[at(3 * worst) + k] / 3.0;
}

std::string cloth_note(const Pattern& pattern) {
    std::string names;
    Index count = 0;
    for (const PatternPiece& piece : pattern.pieces)
        if (!piece.cloth.is_within) {
            ++count;
            names += (names.empty() ? "" : ", ") + piece.name;
        }
    if (count == 0)
        return "";
    return std::to_string(count) + " of " + std::to_string(pattern.pieces.size()) +
           (count == 1 ? " pieces strains " : " pieces strain ") + pattern.material->name +
           " beyond its limits (" + names + "): give more pieces or a softer material";
}

} // namespace devseg::pattern
