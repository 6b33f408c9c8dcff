#include "unit/checks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "devseg/atlas/disks.h"

namespace devseg::checks {

namespace {

class UnionFind {
public:
    explicit UnionFind(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    Index find(Index i) {
        while (parent_[i] != i)
            i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(Index a, Index b) { parent_[find(a)] = find(b); }

private:
    std::vector<Index> parent_;
};

Vec2 crossing(const Vec2& a, const Vec2& b, double side_a, double side_b) {
    return a + (b - a) * (side_a / (side_a - side_b));
}

double cross(const Vec2& a, const Vec2& b) {
    return a.x() * b.y() - a.y() * b.x();
}

} // namespace

Mesh gated(const mesh::RawMesh& raw) {
    return mesh::gate_mesh(raw).mesh;
}

atlas::ChartMap components(const Mesh& mesh) {
    return atlas::make_chart_map(mesh, std::vector<Index>(mesh.faces.size(), 0), {}, false);
}

atlas::ChartMap components_cut_to_disks(const Mesh& mesh) {
    Progress progress;
    return atlas::cut_charts_to_disks(mesh, components(mesh), progress).charts;
}

Disk::Disk(const mesh::RawMesh& raw) : Disk(raw, [](const Vec3&) { return false; }) {}

Disk::Disk(const mesh::RawMesh& raw, const std::function<bool(const Vec3& middle)>& cut)
    : mesh(gated(raw)) {
    std::vector<std::uint8_t> seam;
    for (const HalfEdge h : mesh.all_half_edges())
        seam.push_back(cut(0.5 * (mesh.points[mesh.origin(h)] + mesh.points[mesh.target(h)])) ? 1
                                                                                              : 0);
    const atlas::ChartMap whole =
        atlas::make_chart_map(mesh, std::vector<Index>(mesh.faces.size(), 0), seam, false);
    Progress progress;
    charts = atlas::cut_charts_to_disks(mesh, whole, {false, {}, atlas::HoleRule::none()}, progress)
                 .charts;
    surface = atlas::extract_charts(mesh, charts).at(0);
    problem = flatten::make_flattening_problem(mesh, surface);
}

testing::AssertionResult is_valid(const Mesh& mesh) {
    if (mesh.twin.size() != 3 * mesh.faces.size())
        return testing::AssertionFailure() << "3 #F twins expected, found " << mesh.twin.size();
    UnionFind fans(mesh.twin.size());
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index opposite = mesh.twin[h];
        if (mesh.origin(h) < 0 || mesh.origin(h) >= mesh.vertex_count())
            return testing::AssertionFailure() << "corner " << h << " names no vertex";
        if (opposite < 0)
            continue;
        if (mesh.twin[opposite] != h)
            return testing::AssertionFailure() << "twins of " << h << " are not mutual";
        if (mesh.origin(h) != mesh.target(opposite) || mesh.target(h) != mesh.origin(opposite))
            return testing::AssertionFailure() << "twins of " << h << " run in one direction";
        fans.join(h, Mesh::next(opposite));
        fans.join(Mesh::next(h), opposite);
    }
    std::vector<std::set<Index>> fans_of(mesh.points.size());
    for (const HalfEdge h : mesh.all_half_edges())
        fans_of[mesh.origin(h)].insert(fans.find(h));
    for (std::size_t v = 0; v < fans_of.size(); ++v)
        if (fans_of[v].size() != 1)
            return testing::AssertionFailure()
                   << "vertex " << v << " has " << fans_of[v].size() << " fans of faces";
    return testing::AssertionSuccess();
}

testing::AssertionResult is_valid(const Mesh& mesh, const atlas::ChartMap& charts) {
    if (charts.chart.size() != mesh.faces.size() || charts.seam.size() != mesh.twin.size())
        return testing::AssertionFailure() << "sizes do not match the mesh";
    UnionFind parts(mesh.faces.size());
    for (const HalfEdge h : mesh.all_half_edges()) {
        const Index opposite = mesh.twin[h];
        if (opposite < 0)
            continue;
        if (charts.seam[h] != charts.seam[opposite])
            return testing::AssertionFailure() << "the seam at " << h << " has one side only";
        const bool border = charts.chart[h / 3] != charts.chart[opposite / 3];
        if (border && charts.seam[h] == 0)
            return testing::AssertionFailure() << "no seam between two charts at " << h;
        if (charts.seam[h] == 0)
            parts.join(h / 3, opposite / 3);
    }
    std::map<Index, std::set<Index>> parts_of;
    for (const Face f : mesh.all_faces())
        parts_of[charts.chart[f]].insert(parts.find(f));
    if (static_cast<Index>(parts_of.size()) != charts.count || parts_of.begin()->first != 0 ||
        parts_of.rbegin()->first != charts.count - 1)
        return testing::AssertionFailure() << "labels are not 0 to " << charts.count - 1;
    for (const auto& [chart, found] : parts_of)
        if (found.size() != 1)
            return testing::AssertionFailure()
                   << "chart " << chart << " falls into " << found.size() << " parts";
    return testing::AssertionSuccess();
}

Topology topology(const Mesh& mesh, const atlas::ChartMap& charts, Index chart) {
    const auto glued = [&](Index h) { return mesh.twin[h] >= 0 && charts.seam[h] == 0; };
    UnionFind corners(mesh.twin.size());
    UnionFind borders(mesh.twin.size()); // boundary half-edges that meet at a vertex
    Index edges_twice = 0;
    Index faces = 0;
    for (const HalfEdge h : mesh.all_half_edges()) {
        if (charts.chart[h / 3] != chart)
            continue;
        faces += h % 3 == 0 ? 1 : 0;
        edges_twice += glued(h) ? 1 : 2;
        if (glued(h)) {
            corners.join(h, Mesh::next(mesh.twin[h]));
            corners.join(Mesh::next(h), mesh.twin[h]);
        }
    }
    std::set<Index> vertices;
    std::map<Index, Index> leaving; // welded corner → boundary half-edge that starts there
    for (const HalfEdge h : mesh.all_half_edges())
        if (charts.chart[h / 3] == chart) {
            vertices.insert(corners.find(h));
            if (!glued(h))
                leaving[corners.find(h)] = h;
        }
    std::set<Index> loops;
    for (const auto& [corner, h] : leaving)
        borders.join(h, leaving.at(corners.find(Mesh::next(h))));
    for (const auto& [corner, h] : leaving)
        loops.insert(borders.find(h));
    return {static_cast<Index>(vertices.size()) - edges_twice / 2 + faces,
            static_cast<Index>(loops.size())};
}

testing::AssertionResult is_sound(const Mesh& mesh, const atlas::ChartMap& charts, Index chart) {
    const Topology found = topology(mesh, charts, chart);
    if (found.euler == 1 && found.loops == 1)
        return testing::AssertionSuccess();
    if (found.loops > 1 && found.euler == 2 - found.loops &&
        atlas::is_sound(mesh, atlas::extract_charts(mesh, charts).at(at(chart))))
        return testing::AssertionSuccess();
    return testing::AssertionFailure() << "chart " << chart << ": V - E + F = " << found.euler
                                       << ", " << found.loops << " loops";
}

std::array<double, 2> stretches(const flatten::FlatteningProblem& problem,
                                const std::vector<Vec2>& uv, std::size_t f) {
    // First fundamental forms of both triangles in the basis of the edges 0→1 and 0→2; σ² are
    // the generalised eigenvalues.
    const Triangle& t = problem.faces[f];
    const Vec2 p = uv[t[1]] - uv[t[0]];
    const Vec2 q = uv[t[2]] - uv[t[0]];
    const Vec2 a = problem.edges[f].col(0);
    const Vec2 b = problem.edges[f].col(1);
    const double rest = a.squaredNorm() * b.squaredNorm() - a.dot(b) * a.dot(b);
    const double trace = (p.squaredNorm() * b.squaredNorm() - 2.0 * p.dot(q) * a.dot(b) +
                          q.squaredNorm() * a.squaredNorm()) /
                         rest;
    const double determinant = std::pow(cross(p, q), 2) / rest;
    const double root = std::sqrt(std::max(0.0, 0.25 * trace * trace - determinant));
    const double large = 0.5 * trace + root;
    return {std::sqrt(large), std::sqrt(determinant / large)};
}

double l2_stretch(const flatten::FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double sum = 0.0;
    double area = 0.0;
    for (std::size_t f = 0; f < problem.faces.size(); ++f) {
        const auto [large, small] = stretches(problem, uv, f);
        const double rest = 0.5 * std::abs(cross(problem.edges[f].col(0), problem.edges[f].col(1)));
        sum += rest * 0.5 * (1.0 / (large * large) + 1.0 / (small * small));
        area += rest;
    }
    return std::sqrt(sum / area);
}

Index count_flips(const std::vector<Triangle>& faces, const std::vector<Vec2>& uv) {
    using Extended = long double;
    Index flips = 0;
    for (const Triangle& t : faces) {
        const auto difference = [&](std::size_t i, int axis) {
            return static_cast<Extended>(uv[t[i]][axis]) - static_cast<Extended>(uv[t[0]][axis]);
        };
        const Extended area =
            difference(1, 0) * difference(2, 1) - difference(1, 1) * difference(2, 0);
        flips += area > 0 ? 0 : 1;
    }
    return flips;
}

double common_area(const Corners& a, const Corners& b) {
    std::vector<Vec2> polygon(a.begin(), a.end());
    const double turn = cross(b[1] - b[0], b[2] - b[0]) > 0.0 ? 1.0 : -1.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 edge = turn * (b[(k + 1) % 3] - b[k]);
        std::vector<Vec2> clipped;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            const Vec2& p = polygon[i];
            const Vec2& q = polygon[(i + 1) % polygon.size()];
            const double side_p = cross(edge, p - b[k]);
            const double side_q = cross(edge, q - b[k]);
            if (side_p >= 0.0)
                clipped.push_back(p);
            if ((side_p > 0.0 && side_q < 0.0) || (side_p < 0.0 && side_q > 0.0))
                clipped.push_back(crossing(p, q, side_p, side_q));
        }
        polygon = std::move(clipped);
    }
    double twice = 0.0;
    for (std::size_t i = 0; i + 1 < polygon.size(); ++i)
        twice += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]);
    return 0.5 * std::abs(twice);
}

testing::AssertionResult contains(const std::string& text, const std::string& part) {
    if (text.find(part) != std::string::npos)
        return testing::AssertionSuccess();
    return testing::AssertionFailure() << '"' << part << "\" is not in \"" << text << '"';
}

} // namespace devseg::checks
