#include "devseg/pattern/optimize.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "devseg/atlas/holes.h"
#include "devseg/base/errors.h"
#include "devseg/flatten/energy/distortion.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/metrics/conic_proxy.h"
#include "devseg/plane/overlap.h"
#include "devseg/plane/plane.h"

namespace devseg::pattern {

namespace {

// What joining may add to the symmetric Dirichlet energy of the worse part.
constexpr double energy_increase = 0.02;

// Both sides of every seam agree to this share where a flattening kept the lengths.
constexpr double kept_length = 1e-3;

// The map of a chart at the scale of the layout, positively oriented.
flatten::FlatChart read_chart(const CornerUv& uv, double scale, atlas::ChartSurface surface) {
    double area = 0.0;
    for (const Face f : surface.face)
        area += plane::uv_area(uv, f);
    flatten::FlatChart chart;
    chart.uv = atlas::read_map(surface, uv, {area < 0.0 ? -scale : scale, scale});
    chart.surface = std::move(surface);
    return chart;
}

CornerUv spread(const Mesh& mesh, const std::vector<flatten::FlatChart>& flat) {
    CornerUv uv(mesh.twin.size(), Vec2::Zero());
    for (const flatten::FlatChart& chart : flat)
        for (const HalfEdge h : chart.surface.all_half_edges())
            uv[chart.surface.mesh_half_edge(h)] = chart.uv[chart.surface.origin(h)];
    return uv;
}

// The charts of the layout's seams, with the positions that their corners have.
void rebuild(const Mesh& mesh, const CornerUv& uv, const std::vector<std::uint8_t>& seam,
             FlatLayout& layout) {
    layout.charts =
        atlas::make_chart_map(mesh, std::vector<Index>(mesh.faces.size(), 0), seam, true);
    layout.flat.clear();
    for (atlas::ChartSurface& surface : atlas::extract_charts(mesh, layout.charts))
        layout.flat.push_back(read_chart(uv, 1.0, std::move(surface)));
}

bool keeps_lengths(const Mesh& mesh, const FlatLayout& layout, const CornerUv& uv) {
    for (const HalfEdge h : mesh.all_half_edges()) {
        if (layout.charts.seam[h] == 0)
            continue;
        const double length = mesh.edge_length(h);
        if (std::abs((uv[Mesh::next(h)] - uv[h]).norm() - length) > kept_length * length)
            return false;
    }
    return true;
}

double energy_of(const Mesh& mesh, const flatten::FlatChart& chart) {
    if (!atlas::is_sound(mesh, chart.surface))
        return 1.0;
    const flatten::FlatteningProblem problem =
        flatten::make_flattening_problem(mesh, chart.surface);
    flatten::Positions x(static_cast<Eigen::Index>(chart.uv.size()), 2);
    for (std::size_t v = 0; v < chart.uv.size(); ++v)
        x.row(static_cast<Eigen::Index>(v)) = chart.uv[v].transpose();
    return flatten::distortion(problem, x);
}

// A map of the surface without flips and overlaps, if the method finds one without cuts.
bool flatten_whole(const Mesh& mesh, flatten::FlattenMethod method, flatten::FlatChart& chart,
                   const std::function<bool()>& go_on) {
    const Mesh part = atlas::mesh_of(mesh, chart.surface);
    const atlas::ChartMap one =
        atlas::make_chart_map(part, std::vector<Index>(part.faces.size(), 0), {}, false);
    Progress quiet([&](double, const char*) { return go_on(); });
    const flatten::FlattenResult result = flatten::flatten_charts(part, one, method, quiet);
    if (result.flat.size() != 1 || result.cuts > 0 || result.flat.front().mended)
        return false;
    const flatten::FlatChart& flat = result.flat.front();
    chart.uv.resize(chart.surface.vertex.size());
    for (const HalfEdge h : chart.surface.all_half_edges())
        chart.uv[chart.surface.origin(flat.surface.mesh_half_edge(h))] =
            flat.uv[flat.surface.origin(h)];
    return true;
}

// Mean fitting error of the small chart's faces with the proxy of both charts together.
double joint_error(const Mesh& mesh, const atlas::ChartSurface& small,
                   const atlas::ChartSurface& neighbour) {
    metrics::NormalMoments moments;
    for (const atlas::ChartSurface* surface : {&small, &neighbour})
        for (const Face f : surface->face)
            moments.add(mesh.face_areas[f], mesh.face_normals[f]);
    const metrics::ConicProxy proxy = metrics::fit_conic(moments);
    double error = 0.0;
    for (const Face f : small.face)
        error += mesh.face_areas[f] * proxy.fitting_error(mesh.face_normals[f]);
    return error / atlas::area_of(mesh, small);
}

// While charts are joined: labels of faces and the charts that are left, by label.
class Joiner {
public:
    Joiner(const Mesh& mesh, const OptimizeOptions& options, FlatLayout& layout, Progress& progress)
        : mesh_(mesh), options_(options), layout_(layout), progress_(progress),
          label_(layout.charts.chart) {
        method_ = keeps_lengths(mesh, layout, spread(mesh, layout.flat))
                      ? flatten::FlattenMethod::lpfb
                      : flatten::FlattenMethod::symmetric_dirichlet;
    }

    bool is_small(std::size_t c) const {
        return !layout_.flat[c].surface.face.empty() &&
               atlas::area_of(mesh_, layout_.flat[c].surface) <
                   options_.max_gusset_area * mesh_.total_area;
    }

    // Joins the chart to the first neighbour that takes it; `done` is the share of the work so far.
    bool join(std::size_t c, double done) {
        done_ = done;
        const std::vector<Index> order =
            atlas::neighbour_labels(mesh_, label_, layout_.flat[c].surface);
        return std::any_of(order.begin(), order.end(),
                           [&](Index neighbour) { return join(c, at(neighbour)); });
    }

private:
    bool join(std::size_t c, std::size_t n) {
        const flatten::FlatChart& small = layout_.flat[c];
        const flatten::FlatChart& neighbour = layout_.flat[n];
        if (joint_error(mesh_, small.surface, neighbour.surface) > options_.merge_threshold)
            return false;
        std::vector<std::uint8_t> seam = layout_.charts.seam;
        flatten::FlatChart both;
        both.surface = atlas::join_surfaces(mesh_, small.surface, neighbour.surface, seam);
        const double limit =
            std::max(energy_of(mesh_, small), energy_of(mesh_, neighbour)) + energy_increase;
        if (!atlas::is_sound(mesh_, both.surface) ||
            !flatten_whole(mesh_, method_, both, [&] { return go_on(); }) ||
            energy_of(mesh_, both) > limit)
            return false;
        for (const Face f : small.surface.face)
            label_[f] = static_cast<Index>(n);
        layout_.charts.seam = std::move(seam);
        layout_.flat[n] = std::move(both);
        layout_.flat[c] = flatten::FlatChart{};
        ++layout_.reattached;
        return true;
    }

    // Asks the user while a chart is flattened, which says itself that it was cancelled.
    bool go_on() {
        try {
            progress_.update(done_);
        } catch (const Cancelled&) {
            return false;
        }
        return true;
    }

    const Mesh& mesh_;
    const OptimizeOptions& options_;
    FlatLayout& layout_;
    Progress& progress_;
    double done_ = 0.0;
    std::vector<Index> label_; // #F
    flatten::FlattenMethod method_ = flatten::FlattenMethod::symmetric_dirichlet;
};

double angle_at(const CornerUv& uv, HalfEdge h) {
    return plane::angle_between(uv[Mesh::next(h)] - uv[h], uv[Mesh::previous(h)] - uv[h]);
}

class Zipper {
public:
    Zipper(const Mesh& mesh, const atlas::ChartMap& charts, const CornerUv& uv, double angle)
        : mesh_(mesh), seam_(charts.seam), uv_(uv), angle_(angle) {}

    // Glues from the tip that `h` runs into, whose twin runs back; returns the number of edges.
    Index close(HalfEdge h) {
        Index glued = 0;
        while (glue_edge(h)) {
            ++glued;
            const Index before = boundary_before(h);
            const Index after = boundary_after(mesh_.twin[h]);
            seam_[h] = seam_[mesh_.twin[h]] = 0;
            if (mesh_.twin[before] != after)
                break;
            h = before;
        }
        return glued;
    }

    bool is_open(HalfEdge h) const { return mesh_.twin[h] < 0 || seam_[h] != 0; }

    // Whether h is cut and the outline turns back at its end.
    bool runs_into_tip(HalfEdge h) const {
        return seam_[h] != 0 && mesh_.twin[h] >= 0 && boundary_after(h) == mesh_.twin[h];
    }

    const std::vector<std::uint8_t>& seam() const { return seam_; }
    const CornerUv& uv() const { return uv_; }

private:
    // The edge of the outline after the edge h of it.
    Index boundary_after(HalfEdge h) const {
        Index next = Mesh::next(h);
        while (!is_open(next))
            next = Mesh::next(mesh_.twin[next]);
        return next;
    }

    // The edge of the outline before the edge h of it.
    Index boundary_before(HalfEdge h) const {
        Index before = Mesh::previous(h);
        while (!is_open(before))
            before = Mesh::previous(mesh_.twin[before]);
        return before;
    }

    // The corners of one copy of a vertex; `first` leaves it along the outline.
    std::vector<Index> corners_from(Index first) const {
        std::vector<Index> corners{first};
        while (!is_open(Mesh::previous(corners.back())))
            corners.push_back(mesh_.twin[Mesh::previous(corners.back())]);
        return corners;
    }

    bool glue_edge(HalfEdge h) {
        const Index back = mesh_.twin[h];
        double around = 0.0;
        for (const Index corner : corners_from(back))
            around += angle_at(uv_, corner);
        if (!(std::abs(2.0 * pi - around) <= angle_))
            return false;
        std::vector<Index> corners = corners_from(h);
        const std::vector<Index> others = corners_from(boundary_after(back));
        if (others.front() == h)
            return false; // the only outline is this dart: the chart would have none
        const Vec2 middle = 0.5 * (uv_[h] + uv_[Mesh::next(back)]);
        const Vec2 rounded(in_32_bits(middle.x()), in_32_bits(middle.y()));
        corners.insert(corners.end(), others.begin(), others.end());
        const double side = plane::uv_area(uv_, h / 3);
        std::vector<Vec2> old;
        for (const Index corner : corners) {
            old.push_back(uv_[corner]);
            uv_[corner] = rounded;
        }
        for (const Index corner : corners) {
            const Face f = corner / 3;
            const double area = plane::orientation(uv_[3 * f], uv_[3 * f + 1], uv_[3 * f + 2]);
            if (!(side > 0.0 ? area > 0.0 : area < 0.0)) {
                for (std::size_t i = 0; i < corners.size(); ++i)
                    uv_[corners[i]] = old[i];
                return false;
            }
        }
        return true;
    }

    const Mesh& mesh_;
    std::vector<std::uint8_t> seam_;
    CornerUv uv_;
    double angle_;
};

} // namespace

FlatLayout read_layout(const Mesh& mesh, const CornerUv& uv) {
    FlatLayout layout;
    layout.charts = atlas::charts_from_uv(mesh, uv);
    const atlas::EvenLayout even = atlas::even_layout(mesh, layout.charts, uv);
    if (!(even.scale > 0.0) || !std::isfinite(even.scale))
        throw InvalidMesh("expected texture coordinates that cover an area, found none; run "
                          "'Charts: Flatten' first");
    for (atlas::ChartSurface& surface : atlas::extract_charts(mesh, layout.charts))
        layout.flat.push_back(read_chart(even.uv, even.scale, std::move(surface)));
    layout.is_as_given = even.is_as_given;
    return layout;
}

void remove_overlaps(const Mesh& mesh, FlatLayout& layout, Progress& progress) {
    const double tolerance = plane::layout_tolerance(std::sqrt(mesh.total_area));
    // Every cut makes charts smaller, and a single face overlaps nothing: this ends.
    for (bool again = true; again;) {
        again = false;
        std::vector<std::uint8_t> seam = layout.charts.seam;
        for (const flatten::FlatChart& chart : layout.flat) {
            progress.check();
            const auto pairs = flatten::overlapping_pairs(chart.surface, chart.uv, tolerance);
            if (pairs.empty())
                continue;
            for (const Index local : flatten::separating_path(mesh, chart.surface, pairs)) {
                const HalfEdge h = chart.surface.mesh_half_edge(local);
                seam[h] = seam[mesh.twin[h]] = 1;
            }
            ++layout.overlap_cuts;
            again = true;
        }
        if (again)
            rebuild(mesh, spread(mesh, layout.flat), seam, layout);
    }
}

void reattach_gussets(const Mesh& mesh, const OptimizeOptions& options, FlatLayout& layout,
                      Progress& progress) {
    std::vector<std::size_t> order(layout.flat.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return atlas::area_of(mesh, layout.flat[a].surface) <
               atlas::area_of(mesh, layout.flat[b].surface);
    });
    Joiner joiner(mesh, options, layout, progress);
    for (std::size_t i = 0; i < order.size(); ++i) {
        const double done = static_cast<double>(i) / static_cast<double>(order.size());
        progress.update(done);
        if (joiner.is_small(order[i]))
            joiner.join(order[i], done);
    }
    if (layout.reattached > 0)
        rebuild(mesh, spread(mesh, layout.flat), layout.charts.seam, layout);
}

GluedDarts glue_darts(const Mesh& mesh, const atlas::ChartMap& charts, const CornerUv& uv,
                      double angle) {
    GluedDarts result;
    Zipper zipper(mesh, charts, uv, angle);
    for (const HalfEdge h : mesh.all_half_edges())
        if (zipper.runs_into_tip(h)) {
            const Index glued = zipper.close(h);
            result.edges += glued;
            result.darts += glued > 0 ? 1 : 0;
        }
    result.charts = atlas::make_chart_map(mesh, charts.chart, zipper.seam(), true);
    result.uv = zipper.uv();
    return result;
}

} // namespace devseg::pattern
