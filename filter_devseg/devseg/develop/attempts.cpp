#include "devseg/develop/attempts.h"

#include <algorithm>
#include <cmath>

#include "devseg/mesh/angle_defects.h"

namespace devseg::develop {

namespace {

struct Tuning {
    double held_back = 0.2; // factor of the ease of points that went wrong
    // Factors of the largest defect inside, where all moved too far: by how much, within bounds.
    double least_finer = 0.6;
    double most_finer = 0.9;
    double relieved_defect = 0.15; // radians: what is opened around a fault at first
    int widening = 2;              // attempts after which faults reach one ring farther
    int still = 6;                 // attempt in which the faults' charts stop to move
};
constexpr Tuning tuning;

using Marks = std::vector<std::uint8_t>; // #V

// The vertices where something is wrong.
struct Faults {
    Marks stuck; // defects above the tolerance
    Marks moved; // too far, or into another face
    bool any_stuck = false;
    bool any_moved = false;
    double mean_share = 0.0; // mean displacement over what it may be
};

Faults find_faults(const Mesh& mesh, const DeformOptions& options, const DeformResult& result,
                   const Crossings& crossings) {
    Faults faults{Marks(mesh.points.size(), 0), Marks(mesh.points.size(), 0)};
    for (const auto& [f, g] : crossings)
        for (std::size_t k = 0; k < 3; ++k)
            faults.moved[at(mesh.faces[at(f)][k])] = faults.moved[at(mesh.faces[at(g)][k])] = 1;
    faults.any_moved = !crossings.empty();
    if (!options.adjust_slits)
        return faults;
    Mesh now = mesh;
    now.points = result.points;
    const std::vector<double> defect = mesh::angle_defects(now);
    for (const Index v : inner_vertices(mesh, result.charts.seam))
        if (std::abs(defect[at(v)]) > options.tolerance) {
            faults.stuck[at(v)] = 1;
            faults.any_stuck = true;
        }
    const double diagonal = diagonal_of(mesh.points);
    if (options.max_displacement > 0.0)
        for (std::size_t v = 0; v < mesh.points.size(); ++v)
            if ((result.points[v] - mesh.points[v]).norm() > options.max_displacement * diagonal) {
                faults.moved[v] = 1;
                faults.any_moved = true;
            }
    if (options.max_mean_displacement > 0.0)
        faults.mean_share = result.mean_displacement / (options.max_mean_displacement * diagonal);
    return faults;
}

Marks with_ring(const Mesh& mesh, const Marks& marks) {
    Marks grown = marks;
    for (const HalfEdge h : mesh.all_half_edges())
        if (marks[mesh.origin(h)] != 0)
            grown[mesh.target(h)] = grown[mesh.origin(Mesh::previous(h))] = 1;
    return grown;
}

// All vertices of the charts that have a marked one.
Marks whole_charts(const Mesh& mesh, const atlas::ChartMap& charts, const Marks& marks) {
    Marks wrong(at(charts.count), 0); // by chart
    for (const HalfEdge h : mesh.all_half_edges())
        if (marks[mesh.origin(h)] != 0)
            wrong[at(charts.chart[face_of(h)])] = 1;
    Marks all(mesh.points.size(), 0);
    for (const HalfEdge h : mesh.all_half_edges())
        if (wrong[at(charts.chart[face_of(h)])] != 0)
            all[mesh.origin(h)] = 1;
    return all;
}

} // namespace

double diagonal_of(const std::vector<Vec3>& points) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : points)
        box.extend(p);
    return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

bool learn(const Mesh& mesh, const std::vector<Index>& point_of, const DeformOptions& options,
           const DeformResult& result, const Crossings& crossings, Attempt& attempt) {
    const Faults faults = find_faults(mesh, options, result, crossings);
    const int number = attempt.number++;
    for (std::size_t v = 0; v < faults.moved.size(); ++v)
        if (faults.moved[v] != 0)
            attempt.ease[at(point_of[v])] =
                std::min(attempt.ease[at(point_of[v])], std::pow(tuning.held_back, number + 1));
    if (!options.adjust_slits)
        return faults.any_moved;
    if (faults.mean_share > 1.0)
        attempt.most_turn_inside *=
            std::clamp(std::sqrt(1.0 / faults.mean_share), tuning.least_finer, tuning.most_finer);
    Marks around = faults.moved;
    for (std::size_t v = 0; v < around.size(); ++v) {
        around[v] |= faults.stuck[v];
        attempt.opened[v] |= faults.stuck[v];
    }
    for (int ring = 0; ring <= number / tuning.widening; ++ring)
        around = with_ring(mesh, around);
    const std::vector<double> defect = mesh::angle_defects(mesh);
    const double least = tuning.relieved_defect * std::pow(0.5, number);
    for (std::size_t v = 0; v < around.size(); ++v)
        if (around[v] != 0 && std::abs(defect[v]) > least)
            attempt.opened[v] = 1;
    if (number >= tuning.still && (faults.any_stuck || faults.any_moved)) {
        const Marks still = whole_charts(mesh, result.charts, around);
        for (std::size_t v = 0; v < still.size(); ++v)
            if (still[v] != 0) {
                if (std::abs(defect[v]) > options.tolerance)
                    attempt.opened[v] = 1;
                attempt.ease[at(point_of[v])] = 0.0;
            }
    }
    return faults.any_stuck || faults.any_moved || faults.mean_share > 1.0;
}

} // namespace devseg::develop
