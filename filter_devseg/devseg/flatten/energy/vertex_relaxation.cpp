#include "devseg/flatten/energy/vertex_relaxation.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/plane/plane.h"

namespace devseg::flatten {

namespace {

struct Tuning {
    int halvings = 8;              // of a vertex's step at most
    double least_curvature = 1e-2; // of the Hessian's larger eigenvalue: keeps it convex

    double harmless = 1.005;    // stretch of a face that is no peak anyway
    double usual_share = 0.995; // of the area: what is stretched more may be a peak
    double above_usual = 1.01;  // stretch of a peak over that of the usual faces
    double relief_cost = 0.25;  // growth of the energy's excess over that of an isometry

    // Charts that are isometric but for single spots: there is room for the stretch around them,
    // the energy must be steeper for peaks to count at all, and solving takes longer.
    double low_peak = 1.1;
    double share_of_usual = 0.8; // excess of a peak over that of the usual faces
    double peak_exponent = 15.0; // s (ψ − 1) at the highest peak
    int wide_rings = 8;
    int many_sweeps = 100;
    double most_moves = 4e5; // of vertices: less than that in all sweeps

    // Faces that solvers of single vertices leave behind: needles, whose vertices must move
    // together.
    double standing_out = 1.3; // stretch over that of the usual faces
    int settled_rings = 6;
    std::size_t most_settled = 100; // faces of which the region is made
};
constexpr Tuning tuning;

// |J|² of a face: its Dirichlet energy by the cotangent formula.
double squared_norm(const VertexStar::Face& f, const Vec2& p) {
    return (f.cot_from * (p - f.to).squaredNorm() + f.cot_to * (p - f.from).squaredNorm() +
            f.cot_apex * (f.from - f.to).squaredNorm()) /
           (2.0 * f.area);
}

// What counts as a peak, and how hard it is pressed.
struct Relief {
    double limit = 0.0;    // stretch of faces above which they are peaks
    int rings = 3;         // of faces around peaks, whose vertices move
    int sweeps = 40;       // over these vertices
    double steepness = 20; // s at first: faces with a stretch of 1.4 weigh e² times as much
};

double usual_stretch(const FlatteningProblem& problem, const std::vector<double>& stretches) {
    std::vector<std::size_t> order(stretches.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return stretches[a] < stretches[b]; });
    double area = 0.0;
    for (const std::size_t f : order) {
        area += problem.area[f];
        if (area >= tuning.usual_share * problem.total_area)
            return stretches[f];
    }
    return stretches[order.back()];
}

Relief choose_relief(double peak, double usual) {
    Relief relief;
    if (peak > tuning.low_peak) {
        relief.limit = tuning.above_usual * usual;
        return relief;
    }
    const double density = 0.25 * (peak * peak + 1.0 / (peak * peak)) + 0.5; // ψ of a strip
    return {1.0 + tuning.share_of_usual * (usual - 1.0), tuning.wide_rings, tuning.many_sweeps,
            tuning.peak_exponent / (density - 1.0)};
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
    std::vector<std::uint8_t> seen(twin.size() / 3, 0); // #f
    for (const Face f : faces)
        seen[f] = 1;
    std::vector<Index> region = faces;
    std::vector<Index>& ring = faces;
    for (int depth = 0; depth < rings; ++depth) {
        std::vector<Index> next;
        for (const Face f : ring)
            for (const HalfEdge h : half_edges_of(f))
                mesh::visit_star(twin, h, [&](HalfEdge k) {
                    if (seen[face_of(k)] == 0)
                        next.push_back(face_of(k));
                    seen[face_of(k)] = 1;
                });
        region.insert(region.end(), next.begin(), next.end());
        ring = std::move(next);
    }
    return region;
}

// Vertices of the faces above the limit and of some rings around them, each with a half-edge that
// leaves it.
std::vector<std::pair<Index, Index>> vertices_near(const FlatteningProblem& problem,
                                                   const std::vector<double>& stretches,
                                                   const Relief& relief) {
    std::vector<std::pair<Index, Index>> vertices;
    for (const Face f :
         with_rings(problem.twin, faces_above(relief.limit, stretches), relief.rings))
        for (const HalfEdge h : half_edges_of(f))
            vertices.emplace_back(problem.faces[f][corner_of(h)], h);
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end(),
                               [](const auto& a, const auto& b) { return a.first == b.first; }),
                   vertices.end());
    return vertices;
}

} // namespace

// With d = det J, |J⁻¹|² = |J|² / d²; along p, |J|² is quadratic and d is linear.
double VertexStar::energy(const Vec2& p) const {
    double sum = 0.0;
    for (const Face& f : faces) {
        const double d = plane::cross(f.from - p, f.to - p) / (2.0 * f.area);
        if (!(d > 0.0))
            return infinite;
        const double inverse = 1.0 / d; // as in relax_vertex, to the last bit
        const double density = 0.25 * squared_norm(f, p) * (1.0 + inverse * inverse);
        sum += f.area * (steepness > 0.0 ? std::exp(steepness * (density - 1.0)) : density);
    }
    return sum;
}

void gather_star(const StarSource& source, const std::vector<Vec2>& uv, HalfEdge leaving,
                 VertexStar& star) {
    star.faces.clear();
    mesh::visit_star(source.twin, leaving, [&](HalfEdge k) {
        const Face f = face_of(k);
        const Index e = corner_of(k);
        VertexStar::Face face;
        face.from = uv[source.faces[f][(e + 1) % 3]];
        face.to = uv[source.faces[f][(e + 2) % 3]];
        face.area = source.area[f];
        face.cot_apex = source.cotangent[f][(e + 1) % 3];
        face.cot_from = source.cotangent[f][(e + 2) % 3];
        face.cot_to = source.cotangent[f][e];
        star.faces.push_back(face);
    });
}

Vec2 relax_vertex(const VertexStar& star, const Vec2& start) {
    Vec2 gradient = Vec2::Zero();
    double xx = 0.0;
    double xy = 0.0;
    double yy = 0.0;
    double energy = 0.0;
    for (const VertexStar::Face& f : star.faces) {
        const double d = plane::cross(f.from - start, f.to - start) / (2.0 * f.area);
        if (!(d > 0.0))
            return start; // rounding left no room: nothing can be gained here
        const double q = squared_norm(f, start);
        const Vec2 dq = (f.cot_from * (start - f.to) + f.cot_to * (start - f.from)) / f.area;
        const Vec2 dd = Vec2(f.from.y() - f.to.y(), f.to.x() - f.from.x()) / (2.0 * f.area);
        const double inverse = 1.0 / d;
        const double inverse2 = inverse * inverse;
        const double density = 0.25 * q * (1.0 + inverse2);
        const Vec2 slope = 0.25 * (1.0 + inverse2) * dq - 0.5 * q * inverse2 * inverse * dd;
        const double value =
            f.area * (star.steepness > 0.0 ? std::exp(star.steepness * (density - 1.0)) : density);
        // Of exp(s (ψ − 1)): s e^… ∇ψ, and s e^… (∇²ψ + s ∇ψ ∇ψᵀ).
        const double w = star.steepness > 0.0 ? star.steepness * value : f.area;
        const double mixed = -0.5 * inverse2 * inverse * w;
        const double square = 1.5 * q * inverse2 * inverse2 * w;
        const double even = 0.25 * (f.cot_from + f.cot_to) / f.area * (1.0 + inverse2) * w;
        const double outer = star.steepness * w;
        energy += value;
        gradient += w * slope;
        xx += even + 2.0 * mixed * dq.x() * dd.x() + square * dd.x() * dd.x() +
              outer * slope.x() * slope.x();
        yy += even + 2.0 * mixed * dq.y() * dd.y() + square * dd.y() * dd.y() +
              outer * slope.y() * slope.y();
        xy += mixed * (dq.x() * dd.y() + dq.y() * dd.x()) + square * dd.x() * dd.y() +
              outer * slope.x() * slope.y();
    }
    const double mean = 0.5 * (xx + yy);
    const double radius = std::hypot(0.5 * (xx - yy), xy);
    const double floor = tuning.least_curvature * (std::abs(mean) + radius);
    const double shift = std::max(0.0, floor - (mean - radius));
    xx += shift;
    yy += shift;
    const double det = xx * yy - xy * xy;
    if (!(det > 0.0))
        return start;
    const Vec2 step(-(yy * gradient.x() - xy * gradient.y()) / det,
                    -(xx * gradient.y() - xy * gradient.x()) / det);
    double t = 1.0;
    for (int i = 0; i < tuning.halvings; ++i, t *= 0.5) {
        const Vec2 p = start + t * step;
        if (star.energy(p) < energy)
            return p;
    }
    return start;
}

Vec2 kernel_point(const VertexStar& star, const Vec2& hint) {
    Eigen::AlignedBox2d box(hint);
    for (const VertexStar::Face& f : star.faces) {
        box.extend(f.from);
        box.extend(f.to);
    }
    std::vector<Vec2> polygon{
        box.corner(Eigen::AlignedBox2d::BottomLeft), box.corner(Eigen::AlignedBox2d::BottomRight),
        box.corner(Eigen::AlignedBox2d::TopRight), box.corner(Eigen::AlignedBox2d::TopLeft)};
    std::vector<Vec2> clipped;
    for (const VertexStar::Face& f : star.faces) {
        clipped.clear();
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Vec2& a = polygon[i];
            const Vec2& b = polygon[(i + 1) % polygon.size()];
            const double side_a = plane::cross(f.from - a, f.to - a);
            const double side_b = plane::cross(f.from - b, f.to - b);
            if (side_a >= 0.0)
                clipped.push_back(a);
            if ((side_a > 0.0 && side_b < 0.0) || (side_a < 0.0 && side_b > 0.0))
                clipped.push_back(a + (side_a / (side_a - side_b)) * (b - a));
        }
        polygon.swap(clipped);
    }
    if (polygon.empty())
        return hint;
    double area = 0.0;
    Vec2 centre = Vec2::Zero();
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
        const double a = plane::cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
        area += a;
        centre += a / 3.0 * (polygon[0] + polygon[i] + polygon[i + 1]);
    }
    return area > 0.0 ? Vec2(centre / area) : polygon.front();
}

bool turn_back(const FlatteningProblem& problem, std::vector<Vec2>& uv) {
    VertexStar star;
    for (bool moved = true; moved;) {
        moved = false;
        bool is_flipped = false;
        for (const HalfEdge h : Range<HalfEdgeKind>(0, static_cast<Index>(problem.twin.size()))) {
            if (jacobian(problem, uv, face_of(h)).determinant() > 0.0)
                continue;
            is_flipped = true;
            const Vertex v = problem.faces[face_of(h)][corner_of(h)];
            if (!mesh::visit_star(problem.twin, h, [](Index) {}))
                continue; // on the outline
            gather_star({problem.faces, problem.twin, problem.area, problem.cotangent}, uv, h,
                        star);
            const Vec2 p = kernel_point(star, uv[v]);
            if (star.energy(p) < infinite) {
                uv[v] = p;
                moved = true;
            }
        }
        if (!is_flipped)
            return true;
    }
    return false;
}

void settle_peaks(const FlatteningProblem& problem, std::vector<Vec2>& uv,
                  const Progress& progress) {
    const std::vector<double> stretches = face_stretches(problem, uv);
    std::vector<Index> faces =
        faces_above(tuning.standing_out * usual_stretch(problem, stretches), stretches);
    if (faces.empty())
        return;
    if (faces.size() > tuning.most_settled) {
        std::stable_sort(faces.begin(), faces.end(),
                         [&](Index a, Index b) { return stretches[a] > stretches[b]; });
        faces.resize(tuning.most_settled);
    }
    const PartialProblem part =
        part_of(problem, with_rings(problem.twin, std::move(faces), tuning.settled_rings));
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

void relieve_peaks(const FlatteningProblem& problem, bool hold_boundary, std::vector<Vec2>& uv,
                   const Progress& progress) {
    const std::vector<double> stretches = face_stretches(problem, uv);
    const double peak = *std::max_element(stretches.begin(), stretches.end());
    if (peak <= tuning.harmless)
        return;
    Relief relief = choose_relief(peak, usual_stretch(problem, stretches));
    auto vertices = vertices_near(problem, stretches, relief);
    if (hold_boundary)
        vertices.erase(std::remove_if(vertices.begin(), vertices.end(),
                                      [&](const auto& entry) {
                                          return !mesh::visit_star(problem.twin, entry.second,
                                                                   [](Index) {});
                                      }),
                       vertices.end());
    if (vertices.empty())
        return;
    relief.sweeps = std::min(
        relief.sweeps, static_cast<int>(tuning.most_moves / static_cast<double>(vertices.size())));
    const double before = symmetric_dirichlet_energy(problem, uv) - 1.0;
    VertexStar star;
    for (const double softer : {1.0, 0.5, 0.25}) {
        std::vector<Vec2> moved = uv;
        star.steepness = softer * relief.steepness;
        for (int i = 0; i < relief.sweeps; ++i) {
            progress.check();
            for (const auto& [v, leaving] : vertices) {
                gather_star({problem.faces, problem.twin, problem.area, problem.cotangent}, moved,
                            leaving, star);
                moved[v] = relax_vertex(star, moved[v]);
            }
        }
        if (symmetric_dirichlet_energy(problem, moved) - 1.0 <=
                (1.0 + tuning.relief_cost) * before &&
            largest_stretch(problem, moved) < peak) {
            uv = std::move(moved);
            return;
        }
    }
}

} // namespace devseg::flatten
