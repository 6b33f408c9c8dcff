#include "devseg/flatten/energy/peaks.h"

#include <algorithm>
#include <cmath>

#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/flatten/energy/vertex_relaxation.h"

namespace devseg::flatten {

namespace {

constexpr double harmless = 1.005;    // stretch of a face that is no peak anyway
constexpr double usual_share = 0.995; // of the area: what is stretched more may be a peak
constexpr double allowed_cost = 0.25; // growth of the energy's excess over that of an isometry

// What counts as a peak, and how hard it is pressed.
struct Relief {
    double limit = 0.0;    // stretch of faces above which they are peaks
    int rings = 3;         // of faces around peaks, whose vertices move
    int sweeps = 40;       // over these vertices
    double steepness = 20; // s at first: faces with a stretch of 1.4 weigh e² times as much
};

constexpr double above_usual = 1.01; // stretch of a peak over that of the usual faces

// Charts that are isometric but for single spots: there is room for the stretch around them, the
// energy must be steeper for peaks to count at all, and solving takes longer.
constexpr double low_peak = 1.1;
constexpr double share_of_usual = 0.8; // excess of a peak over that of the usual faces
constexpr double peak_exponent = 15.0; // s (ψ − 1) at the highest peak
constexpr int wide_rings = 8;
constexpr int many_sweeps = 100;
constexpr double most_moves = 4e5; // of vertices: less than that in all sweeps
constexpr int least_sweeps = 10;

// Faces that solvers of single vertices leave behind: needles, whose vertices must move together.
constexpr double standing_out = 1.3; // stretch over that of the usual faces
constexpr int settled_rings = 6;
constexpr std::size_t least_settled = 100; // faces of which the region is made,
constexpr std::size_t settled_part = 2000; // or one of so many

double largest_stretch(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double largest = 1.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f)
        largest = std::max(largest, face_stretch(problem, uv, f));
    return largest;
}

double usual_stretch(const FlatteningProblem& problem, const std::vector<double>& stretches) {
    std::vector<std::size_t> order(stretches.size());
    for (std::size_t f = 0; f < order.size(); ++f)
        order[f] = f;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return stretches[a] != stretches[b] ? stretches[a] < stretches[b] : a < b;
    });
    double area = 0.0;
    for (const std::size_t f : order) {
        area += problem.area[f];
        if (area >= usual_share * problem.total_area)
            return stretches[f];
    }
    return stretches[order.back()];
}

Relief choose_relief(double peak, double usual) {
    Relief relief;
    if (peak > low_peak) {
        relief.limit = std::max(harmless, above_usual * usual);
        return relief;
    }
    const double density = 0.25 * (peak * peak + 1.0 / (peak * peak)) + 0.5; // ψ of a strip
    return {1.0 + share_of_usual * (usual - 1.0), wide_rings, many_sweeps,
            peak_exponent / (density - 1.0)};
}

std::vector<double> stretches_of(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    std::vector<double> stretches(problem.faces.size());
    for (std::size_t f = 0; f < stretches.size(); ++f)
        stretches[f] = face_stretch(problem, uv, f);
    return stretches;
}

std::vector<Index> faces_above(double limit, const std::vector<double>& stretches) {
    std::vector<Index> faces;
    for (std::size_t f = 0; f < stretches.size(); ++f)
        if (stretches[f] > limit)
            faces.push_back(static_cast<Index>(f));
    return faces;
}

// The faces with some rings around them.
std::vector<Index> with_rings(const std::vector<HalfEdge>& twin, std::vector<Index> faces,
                              int rings) {
    std::vector<std::uint8_t> seen(twin.size() / 3, 0);
    for (const Face f : faces)
        seen[f] = 1;
    std::vector<Index> region = faces;
    std::vector<Index>& ring = faces;
    for (int depth = 0; depth < rings; ++depth) {
        std::vector<Index> next;
        for (const Face f : ring)
            for (const HalfEdge h : half_edges_of(f))
                mesh::visit_star(twin, h, [&](Index k) {
                    if (seen[k / 3]++ == 0)
                        next.push_back(k / 3);
                    seen[k / 3] = 1;
                });
        region.insert(region.end(), next.begin(), next.end());
        ring = std::move(next);
    }
    return region;
}

// Vertices of the faces above the limit and of some rings around them, each with a half-edge that
// leaves it.
std::vector<std::pair<Index, Index>> vertices_near(const FlatteningProblem& problem,
                                                   const std::vector<HalfEdge>& twin,
                                                   const std::vector<double>& stretches,
                                                   const Relief& relief) {
    std::vector<std::pair<Index, Index>> vertices;
    for (const Face f : with_rings(twin, faces_above(relief.limit, stretches), relief.rings))
        for (Index k = 0; k < 3; ++k)
            vertices.emplace_back(problem.faces[f][k], 3 * f + k);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end(),
                               [](const auto& a, const auto& b) { return a.first == b.first; }),
                   vertices.end());
    return vertices;
}

} // namespace

void settle_peaks(const FlatteningProblem& problem, const std::vector<HalfEdge>& twin,
                  std::vector<Vec2>& uv, const Progress& progress) {
    const std::vector<double> stretches = stretches_of(problem, uv);
    std::vector<Index> faces =
        faces_above(standing_out * usual_stretch(problem, stretches), stretches);
    if (faces.empty())
        return;
    const std::size_t most = std::max(least_settled, problem.faces.size() / settled_part);
    if (faces.size() > most) {
        std::stable_sort(faces.begin(), faces.end(),
                         [&](Index a, Index b) { return stretches[a] > stretches[b]; });
        faces.resize(most);
    }
    const PartialProblem part = part_of(problem, with_rings(twin, std::move(faces), settled_rings));
    SymmetricDirichletOptions options;
    options.fixed = part.fixed;
    std::vector<Vec2> start;
    for (const Vertex v : part.vertex)
        start.push_back(uv[v]);
    const SymmetricDirichletResult settled =
        minimise_symmetric_dirichlet(part.problem, start, options, progress);
    for (std::size_t i = 0; i < part.vertex.size(); ++i)
        uv[part.vertex[i]] = settled.uv[i];
}

void relieve_peaks(const FlatteningProblem& problem, const std::vector<HalfEdge>& twin,
                   bool hold_boundary, std::vector<Vec2>& uv, const Progress& progress) {
    const std::vector<double> stretches = stretches_of(problem, uv);
    const double peak = *std::max_element(stretches.begin(), stretches.end());
    if (peak <= harmless)
        return;
    Relief relief = choose_relief(peak, usual_stretch(problem, stretches));
    auto vertices = vertices_near(problem, twin, stretches, relief);
    if (hold_boundary)
        vertices.erase(std::remove_if(vertices.begin(), vertices.end(),
                                      [&](const auto& entry) {
                                          return !mesh::visit_star(twin, entry.second,
                                                                   [](Index) {});
                                      }),
                       vertices.end());
    if (vertices.empty())
        return;
    relief.sweeps =
        std::min(relief.sweeps,
                 std::max(least_sweeps,
                          static_cast<int>(most_moves / static_cast<double>(vertices.size()))));
    const double before = symmetric_dirichlet_energy(problem, uv) - 1.0;
    VertexStar star;
    for (const double softer : {1.0, 0.5, 0.25}) {
        std::vector<Vec2> moved = uv;
        star.steepness = softer * relief.steepness;
        for (int i = 0; i < relief.sweeps; ++i) {
            progress.check();
            for (const auto& [v, leaving] : vertices) {
                gather_star({problem.faces, twin, problem.area, problem.cotangent}, moved, leaving,
                            star);
                moved[v] = relax_vertex(star, moved[v]);
            }
        }
        if (symmetric_dirichlet_energy(problem, moved) - 1.0 <= (1.0 + allowed_cost) * before &&
            largest_stretch(problem, moved) < peak) {
            uv = std::move(moved);
            return;
        }
    }
}

} // namespace devseg::flatten
