#include "devseg/develop/deform.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <utility>

#include "devseg/atlas/border_path.h"
#include "devseg/atlas/slit_closing.h"
#include "devseg/base/errors.h"
#include "devseg/develop/attempts.h"
#include "devseg/develop/intersections.h"
#include "devseg/develop/projection.h"
#include "devseg/mesh/angle_defects.h"

namespace devseg::develop {

namespace {

struct Tuning {
    // Of the tolerance: Newton's steps gain so much at the end that exactness costs one or two
    // more.
    double polished = 1e-6;
    int gainless_rounds = 4; // at most
    int relaxed_after = 3; // rounds in which a place was blocked; it is cut so many gainless later
    std::size_t most_slits_at_once = 3;
    double late = 0.75;     // share of the rounds
    double late_gain = 0.3; // what the residual has to fall to in `gainless_rounds` then
    int attempts = 3;       // at a surface that does not run through itself, with given slits
    // The same where slits may be cut: the last ones hold whole charts still, one after another.
    int most_attempts = 40;
    double attempt_share = 0.12;   // of the progress that is left: how many follow is not known
    double most_turn_inside = 0.5; // radians: a slit leads to vertices that lack more
    // What saddles may have too much, over what others may lack, where slits did not do yet: slits
    // to them cost parts.
    double saddle_turn = 2.0;
    int most_focused_rounds = 25;
    double most_in_focus = 0.5; // share of the inner vertices
    double focus_share = 0.1;
};
constexpr Tuning tuning;

} // namespace

std::vector<Index> inner_vertices(const Mesh& mesh, const std::vector<std::uint8_t>& seam) {
    const std::vector<Index> cuts = atlas::cut_edges_at_vertices(mesh, seam);
    const std::vector<std::uint8_t> boundary = mesh::boundary_vertices(mesh);
    const std::vector<Index> leaving = mesh::leaving_half_edges(mesh);
    std::vector<Index> inner;
    for (const Vertex v : mesh.all_vertices())
        if (leaving[v] >= 0 && boundary[v] == 0 && cuts[v] == 0)
            inner.push_back(v);
    return inner;
}

namespace {

class Deformation {
public:
    Deformation(const Mesh& mesh, const atlas::ChartMap& charts, const std::vector<Index>& point_of,
                const DeformOptions& options, const Attempt& attempt)
        : mesh_(mesh), point_of_(point_of), options_(options), attempt_(attempt),
          projection_(mesh, point_of, attempt.ease), leaving_(mesh::leaving_half_edges(mesh)),
          kept_open_(attempt.opened) {
        result_.charts = charts;
        constrain_all();
        result_.start_residual = projection_.residual();
    }

    DeformResult run(Progress& progress) {
        const std::vector<Vec3> start = projection_.points();
        iterate(progress);
        if (options_.adjust_slits)
            close_tips(
                [&](Vertex, double defect) { return std::abs(defect) <= options_.tolerance; });
        result_.residual = projection_.residual();
        result_.converged = result_.residual <= options_.tolerance;
        result_.inner_vertices = static_cast<Index>(rows_.size());
        const std::vector<Vec3>& end = projection_.points();
        for (std::size_t p = 0; p < end.size(); ++p) {
            const double moved = (end[p] - start[p]).norm();
            result_.largest_displacement = std::max(result_.largest_displacement, moved);
            result_.mean_displacement += moved / static_cast<double>(end.size());
        }
        for (const Index p : point_of_)
            result_.points.push_back(end[p]);
        return std::move(result_);
    }

private:
    // Alternates deforming and closing until no tip is left with more than 2π around it.
    void iterate(Progress& progress) {
        if (options_.adjust_slits)
            open_vertices();
        do
            project(progress);
        while (options_.adjust_slits && projection_.residual() <= options_.tolerance &&
               effort_ < options_.max_iterations && close_tips([&](Vertex v, double defect) {
                   return kept_open_[v] == 0 && defect < -options_.tolerance &&
                          defect >= -tuning.most_turn_inside;
               }));
    }

    // Closes the last edge of slits to such vertices, and what is exact behind it.
    template <class MayClose>
    bool close_tips(MayClose may_close) {
        Mesh now = mesh_;
        for (std::size_t v = 0; v < now.points.size(); ++v)
            now.points[v] = projection_.points()[point_of_[v]];
        const std::vector<double> defect = mesh::angle_defects(now);
        const std::vector<std::uint8_t> boundary = mesh::boundary_vertices(mesh_);
        std::vector<Index> cuts = atlas::cut_edges_at_vertices(mesh_, result_.charts.seam);
        std::vector<std::uint8_t>& seam = result_.charts.seam;
        std::vector<Index> tips(mesh_.points.size()); // the last one comes next
        std::iota(tips.rbegin(), tips.rend(), 0);
        bool any = false;
        while (!tips.empty()) {
            const Vertex v = tips.back();
            tips.pop_back();
            if (boundary[v] != 0 || cuts[v] != 1 || !may_close(v, defect[v]))
                continue;
            HalfEdge edge;
            mesh::visit_star(mesh_, leaving_[v],
                             [&](HalfEdge h) { edge = seam[h] != 0 ? h : edge; });
            const Vertex other = mesh_.target(edge);
            if (boundary[other] == 0 && cuts[other] == 1)
                continue; // the last cut of a closed chart
            seam[edge] = seam[mesh_.twin[edge]] = 0;
            cuts[v] = 0;
            --cuts[other];
            kept_open_[v] = 1; // if it is cut again, it stays so
            ++result_.closed_edges;
            any = true;
            if (std::abs(defect[other]) <= options_.tolerance)
                tips.push_back(other);
        }
        if (any)
            constrain_all();
        return any;
    }

    void constrain_all() {
        rows_ = inner_vertices(mesh_, result_.charts.seam);
        projection_.constrain(rows_, {});
        all_rows_ = rows_.size();
        focused_ = false;
    }

    // Where few charts are left with defects, these are all that has to move.
    bool focus() {
        std::vector<std::uint8_t> open(at(result_.charts.count), 0);
        const auto chart_of = [&](Vertex v) { return result_.charts.chart[face_of(leaving_[v])]; };
        for (Index r = 0; r < projection_.defects().size(); ++r)
            if (std::abs(projection_.defects()[r]) > tuning.focus_share * options_.tolerance)
                open[chart_of(rows_[r])] = 1;
        std::vector<std::uint8_t> near(mesh_.points.size(), 0);
        std::size_t count = 0;
        for (const Vertex v : rows_) {
            near[v] = open[chart_of(v)];
            count += near[v];
        }
        if (static_cast<double>(count) > tuning.most_in_focus * static_cast<double>(rows_.size()))
            return false;
        std::vector<std::uint8_t> outside(mesh_.points.size(), 0);
        std::vector<Index> rows;
        for (const Vertex v : rows_)
            if (near[v] != 0)
                rows.push_back(v);
            else
                outside[v] = 1;
        std::vector<std::uint8_t> fixed(projection_.points().size(), 0);
        for (const Triangle& t : mesh_.faces)
            if ((outside[t[0]] | outside[t[1]] | outside[t[2]]) != 0)
                for (const Vertex v : t)
                    fixed[point_of_[v]] = 1;
        rows_ = std::move(rows);
        projection_.constrain(rows_, fixed);
        focused_ = true;
        return true;
    }

    // Rounds until all defects are as small as rounding lets them be. What is stuck is relaxed, and
    // then cut open if that is allowed.
    void project(Progress& progress) {
        const int cut_after = tuning.relaxed_after + tuning.gainless_rounds;
        int failed = 0;
        int idle = 0;
        int focused_rounds = 0;
        bool may_focus = true;
        while (effort_ < options_.max_iterations) {
            if (projection_.residual() <= tuning.polished * options_.tolerance ||
                focused_rounds > tuning.most_focused_rounds) {
                if (!focused_)
                    return;
                may_focus = focused_rounds <= tuning.most_focused_rounds;
                focused_rounds = 0;
                constrain_all();
                continue;
            }
            if (!focused_ && may_focus && projection_.residual() > options_.tolerance && focus())
                continue;
            progress.update(effort_ / options_.max_iterations);
            const double before = projection_.residual();
            const bool moved = projection_.step();
            ++result_.rounds;
            effort_ += static_cast<double>(rows_.size()) / static_cast<double>(all_rows_);
            focused_rounds += focused_ ? 1 : 0;
            idle = projection_.residual() > 0.5 * before ? idle + 1 : 0;
            if (before <= options_.tolerance && idle == tuning.gainless_rounds) {
                if (!focused_)
                    return; // rounding is all that is left
                constrain_all();
                continue;
            }
            failed = moved ? 0 : failed + 1;
            const int block = projection_.longest_block();
            if (block == tuning.relaxed_after)
                projection_.relax_blocked(tuning.relaxed_after);
            else if (block >= cut_after && options_.adjust_slits &&
                     add_slits(cut_after, options_.tolerance, tuning.most_slits_at_once))
                continue;
            if (add_late_slits()) {
                failed = 0;
                continue;
            }
            if (failed < tuning.gainless_rounds)
                continue;
            if (options_.adjust_slits && failed == tuning.gainless_rounds &&
                add_slits(0, options_.tolerance, 1))
                failed = 0;
            if (failed > 2 * tuning.gainless_rounds && !focused_)
                return;
            if (failed > 2 * tuning.gainless_rounds)
                focused_rounds = tuning.most_focused_rounds + 1;
        }
        if (focused_)
            constrain_all();
    }

    // Slits cost parts: they are few as long as there is time, and then as many as it takes.
    bool add_late_slits() {
        const bool is_late = effort_ > tuning.late * options_.max_iterations;
        if (!options_.adjust_slits || !is_late || result_.rounds % tuning.gainless_rounds != 0)
            return false;
        const double residual = projection_.residual();
        const bool added =
            residual > std::max(options_.tolerance, tuning.late_gain * late_residual_) &&
            add_slits(0, std::max(options_.tolerance, 0.1 * residual), rows_.size());
        late_residual_ = projection_.residual();
        return added;
    }

    // Cuts to vertices with defects above `least` that were blocked for so many rounds; to the
    // worst one of each neighbourhood, as others may get on once it is free.
    bool add_slits(int rounds, double least, std::size_t most) {
        std::vector<std::pair<double, Index>> worst;
        const Eigen::VectorXd& defects = projection_.defects();
        for (Index r = 0; r < defects.size(); ++r)
            if (std::abs(defects[r]) > least && projection_.block(r) >= rounds)
                worst.emplace_back(-std::abs(defects[r]), rows_[r]);
        std::sort(worst.begin(), worst.end());
        worst.resize(std::min(worst.size(), most));
        return cut_to(worst, true);
    }

    // Before anything moves: to vertices that lack too much, and to those that had to be opened
    // after other attempts.
    void open_vertices() {
        std::vector<std::pair<double, Index>> opened;
        const Eigen::VectorXd& defects = projection_.defects();
        for (Index r = 0; r < defects.size(); ++r) {
            const double turn = std::max(
                defects[r], -defects[r] / (attempt_.number > 0 ? tuning.saddle_turn : 1.0));
            if (turn > tuning.most_turn_inside || attempt_.opened[at(rows_[r])] != 0)
                opened.emplace_back(-std::abs(defects[r]), rows_[r]);
        }
        std::sort(opened.begin(), opened.end());
        cut_to(opened, false);
    }

    // Cuts from the border to the vertices in their order; of neighbours the first alone, if so
    // asked. Returns whether there was any.
    bool cut_to(const std::vector<std::pair<double, Index>>& vertices, bool first_of_neighbours) {
        std::vector<std::uint8_t> on_border = mesh::boundary_vertices(mesh_);
        const std::vector<Index> cuts = atlas::cut_edges_at_vertices(mesh_, result_.charts.seam);
        for (std::size_t v = 0; v < cuts.size(); ++v)
            on_border[v] = on_border[v] != 0 || cuts[v] > 0;
        std::vector<std::uint8_t> relieved(mesh_.points.size(), 0);
        bool any = false;
        for (const auto& [size, v] : vertices) {
            if (on_border[v] != 0 || relieved[v] != 0 || !cut_to_border(v, on_border))
                continue;
            ++result_.added_slits;
            any = true;
            if (first_of_neighbours)
                mesh::visit_star(mesh_, leaving_[v],
                                 [&](HalfEdge h) { relieved[mesh_.target(h)] = 1; });
        }
        if (any)
            constrain_all();
        return any;
    }

    // False where the vertex has no way to the border of its chart.
    bool cut_to_border(Vertex v, std::vector<std::uint8_t>& on_border) {
        const std::vector<Index>& chart = result_.charts.chart;
        std::vector<Index> faces;
        for (const Face f : mesh_.all_faces())
            if (chart[f] == chart[face_of(leaving_[v])])
                faces.push_back(f);
        const std::vector<Index> path = atlas::path_to_border(mesh_, faces, result_.charts.seam, v);
        atlas::mark_cuts(mesh_, path, result_.charts.seam);
        for (const HalfEdge h : path)
            on_border[mesh_.origin(h)] = on_border[mesh_.target(h)] = 1;
        return !path.empty();
    }

    const Mesh& mesh_;
    const std::vector<Index>& point_of_;
    const DeformOptions& options_;
    const Attempt& attempt_;
    Projection projection_;
    std::vector<Index> rows_; // vertices of the projection's rows
    std::size_t all_rows_ = 0;
    double effort_ = 0.0;             // rounds; those with a part of the rows count by that part
    double late_residual_ = infinite; // at the last late look
    std::vector<Index> leaving_;
    bool focused_ = false;                // whether these are a part of all inner vertices
    std::vector<std::uint8_t> kept_open_; // #V: tips that were closed before, or must be open
    DeformResult result_;
};

// Pairs of faces that cross after the deformation and not before; close to where the surface
// crossed itself already, crossings just move from face to face.
Crossings new_crossings(const std::vector<Triangle>& faces, const std::vector<Vec3>& before,
                        const std::vector<Vec3>& after, const Progress& progress) {
    std::vector<std::uint8_t> crossed(before.size(), 0); // by point
    for (const auto& [f, g] : find_intersections(before, faces, progress))
        for (std::size_t k = 0; k < 3; ++k)
            crossed[faces[f][k]] = crossed[faces[g][k]] = 1;
    const auto had_crossed = [&](Face f) {
        const Triangle& t = faces[f];
        return (crossed[t[0]] | crossed[t[1]] | crossed[t[2]]) != 0;
    };
    Crossings added;
    for (const auto& [f, g] : find_intersections(after, faces, progress))
        if (!had_crossed(f) || !had_crossed(g))
            added.emplace_back(f, g);
    return added;
}

// Throws where the result is not what was asked for.
void check(const DeformResult& result, const DeformOptions& options) {
    std::ostringstream text;
    if (!result.converged)
        text << "expected angle sums of 2 pi to within " << options.tolerance
             << " rad at all inner vertices of the charts, found a defect of " << result.residual
             << " rad after " << result.rounds << " rounds";
    else if (result.new_intersections > 0)
        text << "expected a surface that does not run through itself, found "
             << result.new_intersections << " new pairs of faces that intersect";
    else
        return;
    text << "; use more charts, set 'adjust_slits', or set 'keep_unfinished' to get the best state";
    throw NumericalFailure(text.str());
}

} // namespace

DeformResult deform_to_developable(const Mesh& mesh, const atlas::ChartMap& charts,
                                   const std::vector<Index>& point_of, const DeformOptions& options,
                                   Progress& progress) {
    check_ranges(options);
    std::vector<Triangle> faces;
    for (const Triangle& t : mesh.faces)
        faces.push_back({point_of[t[0]], point_of[t[1]], point_of[t[2]]});
    const auto by_point = [&](const std::vector<Vec3>& vertices) {
        std::vector<Vec3> points(at(*std::max_element(point_of.begin(), point_of.end())) + 1,
                                 Vec3::Zero());
        for (std::size_t v = 0; v < point_of.size(); ++v)
            points[point_of[v]] = vertices[v];
        return points;
    };
    const std::vector<Vec3> before = by_point(mesh.points);
    Attempt attempt{std::vector<double>(before.size(), 1.0),
                    std::vector<std::uint8_t>(mesh.points.size(), 0)};
    const int attempts = options.adjust_slits ? tuning.most_attempts : tuning.attempts;
    DeformResult result;
    while (true) {
        auto deforming = progress.part("deforming to exact developability",
                                       tuning.attempt_share * progress.left());
        DeformResult next = Deformation(mesh, charts, point_of, options, attempt).run(deforming);
        if (attempt.number > 0 && !options.adjust_slits && !next.converged)
            break;
        result = std::move(next);
        Crossings added;
        if (result.converged) {
            auto looking = progress.part("looking for intersections", 0.02 * progress.left());
            added = new_crossings(faces, before, by_point(result.points), looking);
        }
        result.new_intersections = static_cast<Index>(added.size());
        if (!learn(mesh, point_of, options, result, added, attempt) || attempt.number == attempts)
            break;
    }
    if (!options.keep_unfinished)
        check(result, options);
    return result;
}

} // namespace devseg::develop
