#include "devseg/methods/plush/skeleton.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>
#include <sstream>

#include <Eigen/SparseCholesky>

#include "devseg/base/errors.h"
#include "devseg/methods/plush/surface_fields.h"

namespace devseg::plush {

namespace {

constexpr std::size_t most_bones = 6; // that influence one vertex: the others add up to little
constexpr double least_weight = 1e-3;
// Heat from a bone against heat along the surface: 1 in [BP07], where a stout body takes the heat
// of its limbs.
constexpr double conductance = 10.0;
// Squared sine of the angle between bones and normal from which on bones have a direction on the
// surface: about 20 degrees.
constexpr double lying = 0.12;

double squared_distance(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 edge = b - a;
    const double length2 = edge.squaredNorm();
    const double t = length2 > 0.0 ? std::clamp((p - a).dot(edge) / length2, 0.0, 1.0) : 0.0;
    return (a + t * edge - p).squaredNorm();
}

[[noreturn]] void refuse_line(const std::string& path, int line, const std::string& found) {
    throw InvalidParameter("skeleton_file: expected lines 'v X Y Z' and 'l I J' with joints "
                           "counted from 1, found '" +
                           found + "' in line " + std::to_string(line) + " of " + path);
}

void read_bones(std::istringstream& words, Skeleton& skeleton, bool& is_valid) {
    Index previous = -1;
    for (long joint = 0; words >> joint; previous = static_cast<Index>(joint - 1)) {
        is_valid = is_valid && joint >= 1 && joint <= static_cast<long>(skeleton.joints.size());
        if (!is_valid)
            return;
        if (previous >= 0 && previous != joint - 1)
            skeleton.bones.push_back({previous, static_cast<Index>(joint - 1)});
    }
    is_valid = is_valid && previous >= 0 && words.eof();
}

} // namespace

Skeleton read_skeleton(const std::string& path, const std::function<Vec3(const Vec3&)>& to_mesh) {
    std::ifstream file(path);
    if (!file)
        throw FileError("skeleton_file: expected a file of joints and bones, but " + path +
                        " cannot be read");
    Skeleton skeleton;
    std::string text;
    for (int line = 1; std::getline(file, text); ++line) {
        std::istringstream words(text);
        words.imbue(std::locale::classic());
        std::string key;
        if (!(words >> key) || key[0] == '#')
            continue;
        bool is_valid = true;
        if (key == "v") {
            Vec3 p;
            is_valid = static_cast<bool>(words >> p.x() >> p.y() >> p.z()) && p.allFinite();
            skeleton.joints.push_back(is_valid ? to_mesh(p) : p);
        } else if (key == "l") {
            read_bones(words, skeleton, is_valid);
        } else {
            is_valid = key == "o" || key == "g" || key == "s";
        }
        if (!is_valid)
            refuse_line(path, line, text);
    }
    if (skeleton.empty())
        throw InvalidParameter("skeleton_file: expected at least one bone (a line 'l I J'), found "
                               "none in " +
                               path);
    return skeleton;
}

BoneWeights bone_weights(const Mesh& mesh, const Skeleton& skeleton, const Progress& progress) {
    const std::vector<double> areas = vertex_areas(mesh);
    Eigen::SparseMatrix<double> matrix = cotangent_laplacian(mesh);
    std::vector<Index> nearest(mesh.points.size(), 0);
    std::vector<double> heat(mesh.points.size());
    const double floor = 1e-6 * mesh.total_area;
    for (const Vertex v : mesh.all_vertices()) {
        double least = infinite;
        for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
            const auto& [i, j] = skeleton.bones[b];
            const double d =
                squared_distance(mesh.points[v], skeleton.joints[i], skeleton.joints[j]);
            if (d < least) {
                least = d;
                nearest[v] = static_cast<Index>(b);
            }
        }
        heat[v] =
            conductance * std::max(areas[v], 1e-12 * mesh.total_area) / std::max(least, floor);
        matrix.coeffRef(v, v) += heat[v];
    }
    progress.check();
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
    BoneWeights weights(mesh.points.size());
    if (solver.info() != Eigen::Success)
        throw NumericalFailure("expected a solvable heat equation on the surface, found a singular "
                               "one; remesh or clean the mesh first");
    for (std::size_t b = 0; b < skeleton.bones.size(); ++b) {
        progress.check();
        Eigen::VectorXd source = Eigen::VectorXd::Zero(mesh.vertex_count());
        for (const Vertex v : mesh.all_vertices())
            if (nearest[v] == static_cast<Index>(b))
                source[v] = heat[v];
        const Eigen::VectorXd share = solver.solve(source);
        for (const Vertex v : mesh.all_vertices())
            if (share[v] > least_weight)
                weights[v].emplace_back(static_cast<Index>(b), share[v]);
    }
    for (auto& row : weights) {
        std::stable_sort(row.begin(), row.end(),
                         [](const auto& a, const auto& b) { return a.second > b.second; });
        row.resize(std::min(row.size(), most_bones));
        double sum = 0.0;
        for (const auto& entry : row)
            sum += entry.second;
        for (auto& entry : row)
            entry.second /= sum;
    }
    return weights;
}

SkeletonDirection skeleton_direction(const Skeleton& skeleton, const BoneWeights& weights, Index a,
                                     Index b, const Vec3& normal) {
    const Vec3 u = normal.unitOrthogonal();
    const Vec3 v = normal.cross(u);
    double uu = 0.0;
    double uv = 0.0;
    double vv = 0.0;
    for (const Vertex vertex : {a, b})
        for (const auto& [bone, weight] : weights[vertex]) {
            const auto& [i, j] = skeleton.bones[bone];
            const Vec3 along = (skeleton.joints[j] - skeleton.joints[i]).normalized();
            uu += 0.5 * weight * along.dot(u) * along.dot(u);
            uv += 0.5 * weight * along.dot(u) * along.dot(v);
            vv += 0.5 * weight * along.dot(v) * along.dot(v);
        }
    SkeletonDirection result;
    const double difference = std::hypot(uu - vv, 2.0 * uv);
    if (!(difference > 0.0))
        return result;
    const double angle = 0.5 * std::atan2(2.0 * uv, uu - vv);
    result.direction = std::cos(angle) * u + std::sin(angle) * v;
    const double lies = std::clamp((uu + vv) / lying, 0.0, 1.0);
    result.agreement = lies * difference / (uu + vv);
    return result;
}

} // namespace devseg::plush
