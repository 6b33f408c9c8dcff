// References
//   [LZXGG08] L. Liu, L. Zhang, Y. Xu, C. Gotsman, S. J. Gortler: A Local/Global Approach to Mesh
//             Parameterization. Computer Graphics Forum 27(5), 2008.
//             doi:10.1111/j.1467-8659.2008.01290.x
#include "devseg/flatten/maps/arap.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "devseg/base/errors.h"
#include "devseg/flatten/energy/map_tools.h"

namespace devseg::flatten {

namespace {

// The rotation nearest to a Jacobian, mirrored ones included: the signed singular value
// decomposition in closed form. Returned as the image of the unit vector along x.
Vec2 nearest_turn(const Eigen::Matrix2d& j) {
    const Vec2 turn(j(0, 0) + j(1, 1), j(1, 0) - j(0, 1));
    const double length = turn.norm();
    return length > 0.0 ? Vec2(turn / length) : Vec2(1.0, 0.0);
}

Eigen::Matrix2d rotation_of(const Vec2& turn) {
    Eigen::Matrix2d rotation;
    rotation << turn.x(), -turn.y(), turn.y(), turn.x();
    return rotation;
}

// [LZXGG08, equation 6]: every edge of a face wants to be the rest edge, turned.
std::vector<Vec2> global_step(const FlatteningProblem& problem, const Laplacian& laplacian,
                              const std::vector<Vec2>& turns) {
    Positions rhs = Positions::Zero(problem.vertex_count, 2);
    const double scale = 0.5 / problem.total_area; // that of the Laplacian
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Eigen::Matrix2d wanted = scale * rotation_of(turns[f]) * problem.edges[f];
        const std::array<Vec2, 3> edge = {wanted.col(0), wanted.col(1) - wanted.col(0),
                                          -wanted.col(1)};
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec2 force = problem.cotangent[f][k] * edge[k];
            rhs.row(problem.faces[f][k]) -= force.transpose();
            rhs.row(problem.faces[f][(k + 1) % 3]) += force.transpose();
        }
    }
    const Positions solution = laplacian.solve(rhs);
    if (!solution.allFinite())
        throw NumericalFailure("expected a finite map, found one that is not");
    std::vector<Vec2> next(at(problem.vertex_count));
    for (Vertex v = 0; v < problem.vertex_count; ++v)
        next[v] = (solution.row(v) - solution.row(0)).transpose();
    return next;
}

// The turns of all faces, and the energy.
double turn_faces(const FlatteningProblem& problem, const std::vector<Vec2>& uv,
                  std::vector<Vec2>& turns) {
    turns.resize(problem.faces.size());
    double sum = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const Eigen::Matrix2d j = jacobian(problem, uv, f);
        turns[f] = nearest_turn(j);
        sum += problem.area[f] * (j - rotation_of(turns[f])).squaredNorm();
    }
    return sum / problem.total_area;
}

} // namespace

std::vector<Vec2> face_turns(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    std::vector<Vec2> turns;
    turns.reserve(problem.faces.size());
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        turns.push_back(nearest_turn(jacobian(problem, uv, f)));
    return turns;
}

std::vector<Vec2> stitch(const FlatteningProblem& problem, const Laplacian& laplacian,
                         const std::vector<Vec2>& turns, const StitchOptions& options) {
    std::vector<Vec2> uv = global_step(problem, laplacian, turns);
    std::vector<Vec2> own;
    double energy = turn_faces(problem, uv, own);
    for (int i = 0; i < options.rounds || (i < options.most_rounds && count_flips(problem, uv) > 0);
         ++i) {
        uv = global_step(problem, laplacian, own);
        const double gain = energy - turn_faces(problem, uv, own);
        energy -= gain;
        if (energy - gains_to_come * gain > options.give_up_energy)
            return {};
    }
    return uv;
}

double arap_energy(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    std::vector<Vec2> turns;
    return turn_faces(problem, uv, turns);
}

ArapResult minimise_arap(const FlatteningProblem& problem, const std::vector<Vec2>& start,
                         const ArapOptions& options, const Progress& progress) {
    const Laplacian laplacian(problem);
    ArapResult result;
    result.uv = start;
    std::vector<Vec2> turns;
    result.energy = turn_faces(problem, start, turns);
    while (result.rounds < options.max_rounds && !result.converged) {
        progress.check();
        std::vector<Vec2> next = global_step(problem, laplacian, turns);
        const double energy = turn_faces(problem, next, turns);
        result.converged = result.energy - energy <= options.relative_tolerance * result.energy;
        if (!(energy < result.energy))
            break; // at the limit of rounding
        result.uv = std::move(next);
        result.energy = energy;
        ++result.rounds;
    }
    result.flips = count_flips(problem, result.uv);
    return result;
}

} // namespace devseg::flatten
