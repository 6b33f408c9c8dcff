#include "devseg/develop/moved_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "devseg/atlas/holes.h"
#include "devseg/atlas/slit_closing.h"
#include "devseg/develop/attempts.h"
#include "devseg/develop/stiff_faces.h"
#include "devseg/flatten/energy/rest_shape.h"
#include "devseg/flatten/flatten.h"
#include "devseg/flatten/one_chart.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/mesh/angle_defects.h"
#include "devseg/plane/overlap.h"
#include "devseg/plane/plane.h"

namespace devseg::develop {

namespace {

// A run of edges on the border of a part, with one chart on the other side.
struct Hinge {
    double length = 0.0;
    double gap = 0.0; // between both sides before they are glued
    std::vector<HalfEdge> edges;
};

class PartMover {
public:
    PartMover(const Mesh& mesh, const std::vector<Index>& point_of, const DeformOptions& options,
              DeformResult& result)
        : mesh_(mesh), point_of_(point_of), options_(options), result_(result),
          now_(with_points(mesh, result.points)), defect_(mesh::angle_defects(now_)),
          boundary_(mesh::boundary_vertices(mesh)), diagonal_(diagonal_of(mesh.points)) {}

    void run(Progress& progress) {
        const Index wanted = result_.charts.count;
        auto separating = progress.part("laying parts beside each other", 0.2);
        flatten::FlattenResult flat = flatten::flatten_charts(
            now_, result_.charts, flatten::FlattenMethod::symmetric_dirichlet, separating);
        if (flat.cuts == 0)
            return;
        std::vector<std::pair<double, Face>> parts; // area, a face
        for (const flatten::FlatChart& chart : flat.flat)
            if (chart.cut_off)
                parts.emplace_back(atlas::area_of(now_, chart.surface), chart.surface.face.front());
        std::sort(parts.begin(), parts.end());
        result_.charts = std::move(flat.charts);
        auto moving = progress.part("moving parts to other charts", progress.left());
        for (const auto& [area, face] : parts) {
            if (result_.charts.count <= wanted)
                break;
            auto one = moving.part(moving.left() / static_cast<double>(parts.size()));
            move(face, flatten::least_hinge * std::sqrt(area), one);
        }
    }

private:
    void move(Face face, double least, Progress& progress) {
        const Index part = result_.charts.chart[face];
        const Buckets<Index> groups = atlas::group_faces(result_.charts);
        const atlas::ChartSurface surface = atlas::extract_surface(
            now_, {groups[part].begin(), groups[part].end()}, result_.charts.seam);
        std::vector<Hinge> hinges = find_hinges(surface, least);
        for (const Hinge& hinge : hinges) {
            progress.check();
            const Index other = result_.charts.chart[now_.across(hinge.edges.front())];
            std::vector<Index> faces(groups[other].begin(), groups[other].end());
            faces.insert(faces.end(), surface.face.begin(), surface.face.end());
            std::sort(faces.begin(), faces.end());
            auto trying = progress.part(0.5 * progress.left());
            if (has_room(hinge, faces) && glue(hinge, part, other, trying))
                return;
        }
    }

    // The longest one to each neighbour that may be glued, the longest of all first.
    std::vector<Hinge> find_hinges(const atlas::ChartSurface& part, double least) const {
        const std::vector<Index> cuts = atlas::cut_edges_at_vertices(now_, result_.charts.seam);
        const auto other_of = [&](HalfEdge h) {
            return now_.twin[h] < 0 ? -1 : result_.charts.chart[now_.across(h)];
        };
        std::vector<Hinge> best(at(result_.charts.count));
        for (const std::vector<Index>& loop : part.loops) {
            const std::size_t n = loop.size();
            const auto edge = [&](std::size_t i) {
                return part.mesh_half_edge(HalfEdge(loop[i % n]));
            };
            for (std::size_t first = 0; first < n; ++first) {
                const Index other = other_of(edge(first));
                if (other < 0 || other == result_.charts.chart[face_of(edge(first))])
                    continue;
                Hinge hinge;
                double turn = 0.0; // of the vertices that come inside
                for (std::size_t i = first; i < first + n - 1 && other_of(edge(i)) == other; ++i) {
                    const Vertex v = now_.origin(edge(i));
                    if (i > first) {
                        if (boundary_[v] != 0 || cuts[v] != 2)
                            break;
                        turn += std::abs(defect_[v]);
                    }
                    const double length = hinge.length + now_.edge_length(edge(i));
                    if (turn * length > options_.max_displacement * diagonal_)
                        break;
                    hinge.length = length;
                    hinge.gap = turn * length;
                    hinge.edges.push_back(edge(i));
                }
                if (hinge.length >= least && hinge.length > best[at(other)].length)
                    best[at(other)] = std::move(hinge);
            }
        }
        std::vector<Hinge> found;
        for (Hinge& hinge : best)
            if (!hinge.edges.empty())
                found.push_back(std::move(hinge));
        std::stable_sort(found.begin(), found.end(),
                         [](const Hinge& a, const Hinge& b) { return a.length > b.length; });
        return found;
    }

    // Whether the exact development of the faces, hung on the middle edge of the hinge, lies beside
    // itself, but for what gluing the rest of it takes away.
    bool has_room(const Hinge& hinge, const std::vector<Index>& faces) const {
        std::vector<std::uint8_t> seam = result_.charts.seam;
        const HalfEdge middle = hinge.edges[hinge.edges.size() / 2];
        seam[middle] = seam[now_.twin[middle]] = 0;
        flatten::FlatChart chart;
        chart.surface = atlas::extract_surface(now_, faces, seam);
        if (!develop(now_, chart))
            return false;
        std::vector<std::array<Vec2, 2>> lines;
        for (const HalfEdge h : chart.surface.all_half_edges())
            if (std::find(hinge.edges.begin(), hinge.edges.end(),
                          chart.surface.mesh_half_edge(h)) != hinge.edges.end())
                lines.push_back(
                    {chart.uv[chart.surface.origin(h)], chart.uv[chart.surface.target(h)]});
        const auto is_far = [&](Index f) {
            const Triangle& t = chart.surface.faces[at(f)];
            return std::all_of(t.begin(), t.end(), [&](Index v) {
                return std::all_of(lines.begin(), lines.end(), [&](const auto& line) {
                    return plane::distance(chart.uv[at(v)], line[0], line[1]) > hinge.gap;
                });
            });
        };
        const flatten::Pairs pairs = flatten::overlapping_pairs(
            chart.surface, chart.uv, plane::layout_tolerance(std::sqrt(now_.model_area())));
        return std::none_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
            return is_far(pair.first) || is_far(pair.second);
        });
    }

    static bool develop(const Mesh& mesh, flatten::FlatChart& chart) {
        return atlas::is_sound(mesh, chart.surface) &&
               flatten::develop(mesh, flatten::make_flattening_problem(mesh, chart.surface), chart);
    }

    static bool lies_beside_itself(const Mesh& mesh, atlas::ChartSurface surface) {
        flatten::FlatChart chart;
        chart.surface = std::move(surface);
        return develop(mesh, chart) &&
               !flatten::overlaps_itself(chart.surface, chart.uv,
                                         plane::layout_tolerance(std::sqrt(mesh.model_area())));
    }

    bool glue(const Hinge& hinge, Index part, Index other, Progress& progress) {
        std::vector<Index> label = result_.charts.chart;
        std::replace(label.begin(), label.end(), part, other);
        std::vector<std::uint8_t> seam = result_.charts.seam;
        for (const HalfEdge h : hinge.edges)
            seam[h] = seam[now_.twin[h]] = 0;
        const atlas::ChartMap charts = atlas::make_chart_map(now_, label, seam, false);
        if (!atlas::is_sound(now_, surface_of(now_, charts, charts.chart[face_of(hinge.edges[0])])))
            return false;
        DeformOptions exact = options_;
        exact.adjust_slits = false;
        exact.keep_unfinished = true;
        DeformResult next = deform_to_developable(now_, charts, point_of_, exact, progress);
        if (!next.converged || next.new_intersections > 0 || !stays_near(next.points))
            return false;
        Mesh moved = with_points(mesh_, next.points);
        if (!all_lie_flat(moved, charts))
            return false;
        now_ = std::move(moved);
        defect_ = mesh::angle_defects(now_);
        result_.charts = charts;
        result_.points = std::move(next.points);
        result_.residual = next.residual;
        result_.inner_vertices = next.inner_vertices;
        result_.rounds += next.rounds;
        ++result_.moved_parts;
        return true;
    }

    // Takes over how far all have moved, if that is allowed.
    bool stays_near(const std::vector<Vec3>& points) {
        double largest = 0.0;
        std::vector<double> moved; // by point
        for (std::size_t v = 0; v < points.size(); ++v) {
            const std::size_t p = at(point_of_[v]);
            moved.resize(std::max(moved.size(), p + 1), 0.0);
            moved[p] = (points[v] - mesh_.points[v]).norm();
            largest = std::max(largest, moved[p]);
        }
        double mean = 0.0;
        for (const double d : moved)
            mean += d / static_cast<double>(moved.size());
        const auto keeps = [&](double value, double most) {
            return !(most > 0.0) || value <= most * diagonal_;
        };
        if (!keeps(largest, options_.max_displacement) ||
            !keeps(mean, options_.max_mean_displacement))
            return false;
        result_.largest_displacement = largest;
        result_.mean_displacement = mean;
        return true;
    }

    static atlas::ChartSurface surface_of(const Mesh& mesh, const atlas::ChartMap& charts,
                                          Index chart) {
        std::vector<Index> faces;
        for (const Face f : mesh.all_faces())
            if (charts.chart[f] == chart)
                faces.push_back(f);
        return atlas::extract_surface(mesh, std::move(faces), charts.seam);
    }

    // Of the charts that have moved.
    bool all_lie_flat(const Mesh& moved, const atlas::ChartMap& charts) const {
        std::vector<std::uint8_t> touched(at(charts.count), 0);
        for (const HalfEdge h : moved.all_half_edges())
            if (moved.points[moved.origin(h)] != now_.points[now_.origin(h)])
                touched[at(charts.chart[face_of(h)])] = 1;
        for (Index c = 0; c < charts.count; ++c)
            if (touched[at(c)] != 0 && !lies_beside_itself(moved, surface_of(moved, charts, c)))
                return false;
        return true;
    }

    const Mesh& mesh_;
    const std::vector<Index>& point_of_;
    const DeformOptions& options_;
    DeformResult& result_;
    Mesh now_;
    std::vector<double> defect_;         // #V, radians, of now_
    std::vector<std::uint8_t> boundary_; // #V
    double diagonal_;
};

} // namespace

void move_parts(const Mesh& mesh, const std::vector<Index>& point_of, const DeformOptions& options,
                DeformResult& result, Progress& progress) {
    PartMover(mesh, point_of, options, result).run(progress);
}

} // namespace devseg::develop
