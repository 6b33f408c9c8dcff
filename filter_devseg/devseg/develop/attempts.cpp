#include "devseg/develop/attempts.h"

#include <algorithm>
#include <cmath>

#include "devseg/mesh/angle_defects.h"

namespace devseg::develop {

namespace {

struct Tuning {
    double held_back = 0.2;        // factor of the ease of points that went wrong
    double relieved_defect = 0.15; // radians: what is opened around a fault at first
    int widening = 2;              // faulty attempts after which faults reach one ring farther
    int still = 6;                 // faulty attempt in which the faults' charts stop to move
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

// Opens the inner vertex that moved farthest of each chart that moved farther than it may in the
// mean; of all where these have none. Returns whether there was any.
bool open_farthest(const Mesh& mesh, const DeformOptions& options, const DeformResult& result,
                   Attempt& attempt) {
    const double most = options.max_mean_displacement * diagonal_of(mesh.points);
    std::vector<double> moved(mesh.points.size());
    for (std::size_t v = 0; v < moved.size(); ++v)
        moved[v] = (result.points[v] - mesh.points[v]).norm();
    std::vector<double> sum(at(result.charts.count), 0.0);
    std::vector<double> corners(sum.size(), 0.0);
    std::vector<Index> chart(moved.size(), -1);
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index c = result.charts.chart[face_of(h)];
        chart[mesh.origin(h)] = c;
        sum[at(c)] += moved[mesh.origin(h)];
        corners[at(c)] += 1.0;
    }
    const std::vector<Index> inner = inner_vertices(mesh, result.charts.seam);
    std::vector<Index> farthest(sum.size(), -1);
    Index of_all = -1;
    const auto take = [&](Index v, Index& best) {
        if (attempt.opened[at(v)] == 0 && (best < 0 || moved[at(v)] > moved[at(best)]))
            best = v;
    };
    for (const Index v : inner) {
        const std::size_t c = at(chart[at(v)]);
        take(v, of_all);
        if (sum[c] > most * corners[c])
            take(v, farthest[c]);
    }
    bool any = false;
    for (const Index v : farthest)
        if (v >= 0) {
            attempt.opened[at(v)] = 1;
            any = true;
        }
    if (!any && of_all >= 0)
        attempt.opened[at(of_all)] = 1;
    return any || of_all >= 0;
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
    const int number = attempt.faulty;
    ++attempt.number;
    for (std::size_t v = 0; v < faults.moved.size(); ++v)
        if (faults.moved[v] != 0)
            attempt.ease[at(point_of[v])] =
                std::min(attempt.ease[at(point_of[v])], std::pow(tuning.held_back, number + 1));
    if (!options.adjust_slits || faults.any_stuck || faults.any_moved)
        ++attempt.faulty;
    if (!options.adjust_slits)
        return faults.any_moved;
    const bool opened = faults.mean_share > 1.0 && open_farthest(mesh, options, result, attempt);
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
    return faults.any_stuck || faults.any_moved || opened;
}

} // namespace devseg::develop
