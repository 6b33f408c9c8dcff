#include "devseg/flatten/one_chart.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "devseg/atlas/join_loops.h"
#include "devseg/flatten/coarse_map.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/energy/multilevel.h"
#include "devseg/flatten/energy/symmetric_dirichlet.h"
#include "devseg/flatten/energy/vertex_relaxation.h"
#include "devseg/flatten/maps/abf.h"
#include "devseg/flatten/maps/arap.h"
#include "devseg/flatten/maps/lpfb_map.h"
#include "devseg/flatten/maps/lscm.h"
#include "devseg/flatten/maps/tutte.h"
#include "devseg/flatten/maps/unfold.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/flatten/repair/slits.h"
#include "devseg/flatten/repair/snap.h"
#include "devseg/plane/overlap.h"
#include "devseg/plane/plane.h"

namespace devseg::flatten {

namespace {

using atlas::ChartSurface;

struct Tuning {
    double collapsed_share = 1e-5; // of its area: a face that keeps less has collapsed
    // A map this many times larger than the chart is of no use: needles had to be opened to wide
    // angles, and the least energy is too far away. The layout would be so large that readers see
    // no slits.
    double blown_up = 100.0;
    // Coarse-to-fine maps of larger charts are settled around needles and then taken as they are:
    // their energy is within 1e-4 of the minimum, and factorizations of the whole chart, to polish
    // it or to push its parts away from each other, would cost more than all levels together.
    Index most_polished_faces = 60000;
    // Of the chart's size: parts that were pushed apart on a coarse version get finer borders
    // later.
    double coarse_gap = 4e-3;
};
constexpr Tuning tuning;

struct Map {
    std::vector<Vec2> uv;
    bool converged = true;
    bool pushed = false; // parts overlapped, and were pushed apart
};

// One chart with all that its maps need. Methods return nothing where they find no map without
// flips, and throw NumericalFailure where a solver inside fails.
class ChartFlattening {
public:
    ChartFlattening(const Mesh& mesh, const ChartSurface& surface, const FlatteningProblem& problem,
                    const WholeChart* whole, const Progress& progress)
        : mesh_(mesh), surface_(surface), problem_(problem),
          tolerance_(plane::layout_tolerance(problem.model_size)), whole_(whole),
          progress_(progress) {}

    std::optional<Map> map(FlattenMethod method) const {
        return attempt([&] { return map_by(method); });
    }

    bool is_good(const std::vector<Vec2>& uv) const {
        return whole_ == nullptr || whole_->is_good(problem_, uv);
    }

private:
    std::optional<Map> map_by(FlattenMethod method) const {
        switch (method) {
        case FlattenMethod::symmetric_dirichlet:
            return isometric();
        case FlattenMethod::lscm:
            return if_sound({flatten_lscm(problem_)});
        case FlattenMethod::abf: {
            AbfResult result = flatten_abf(problem_, AbfOptions{}, progress_);
            return if_sound({std::move(result.uv), result.converged});
        }
        case FlattenMethod::arap:
            return rigid();
        case FlattenMethod::lpfb:
            if (auto map = problem_.holes.empty() ? least_strain() : std::nullopt)
                return map;
            return length_preserving();
        case FlattenMethod::lpfb_even_areas:
            return length_preserving();
        }
        return std::nullopt;
    }

    // Conformal maps of strongly curved charts can shrink faces until 32-bit coordinates flip them.
    std::optional<Map> if_sound(Map map) const {
        if (count_flips(problem_, map.uv) > 0 ||
            !(least_area_ratio(problem_, map.uv) > tuning.collapsed_share))
            return std::nullopt;
        return map;
    }

    // The first map without flips: LSCM, as on all charts that are nearly developable; LPFB; ABF++;
    // Tutte, which rounding can flip on long closed tubes.
    std::optional<std::vector<Vec2>> valid_start(const FlatteningProblem& problem) const {
        using Uv = std::vector<Vec2>;
        const std::function<Uv()> starts[] = {
            [&] { return flatten_lscm(problem); },
            [&] { return flatten_lpfb(problem, LpfbOptions{}, progress_).uv; },
            [&] { return flatten_abf(problem, AbfOptions{}, progress_).uv; },
            [&] { return flatten_tutte(problem); },
        };
        for (const auto& start : starts) {
            Uv uv = attempt(start);
            if (!uv.empty() && count_flips(problem, uv) == 0)
                return uv;
        }
        return std::nullopt;
    }

    std::optional<Map> rigid() const {
        const auto start = valid_start(problem_);
        if (!start)
            return std::nullopt;
        ArapResult result = minimise_arap(problem_, *start, ArapOptions{}, progress_);
        scale_to_area(problem_, result.uv);
        return if_sound({std::move(result.uv), result.converged});
    }

    // Least symmetric Dirichlet energy, without peaks.
    std::optional<Map> isometric() const {
        if (problem_.faces.size() == 1) // needles leave a solver no digits, and need none
            return single_face();
        Map map;
        const bool is_large = surface_.face_count() > tuning.most_polished_faces;
        const auto refined = attempt([&] { return coarse_to_fine(); });
        if (refined) {
            map.uv = *refined;
            settle_peaks(problem_, map.uv, progress_);
        } else if (auto start = valid_start(problem_)) {
            map.uv = std::move(*start);
        } else {
            return std::nullopt;
        }
        if (!refined || !is_large) {
            SymmetricDirichletResult result =
                minimise_symmetric_dirichlet(problem_, map.uv, {}, progress_);
            map = {std::move(result.uv), result.converged};
        }
        relieve_peaks(problem_, false, map.uv, progress_);
        scale_to_area(problem_, map.uv);
        return map;
    }

    Map single_face() const {
        Map map{std::vector<Vec2>(3)};
        for (Index k = 0; k < 3; ++k)
            map.uv[problem_.faces.front()[k]] = problem_.corner(0, k);
        return map;
    }

    // Nothing for small charts. Parts that overlap are pushed apart where that is cheap.
    std::optional<std::vector<Vec2>> coarse_to_fine() const {
        if (surface_.face_count() < multilevel_threshold)
            return std::nullopt;
        const auto solve = [&](const FlatteningProblem& coarse, const ChartSurface& disk) {
            const auto start = valid_start(coarse);
            if (!start)
                throw NumericalFailure("expected a map without flipped faces, found none");
            std::vector<Vec2> uv = minimise_symmetric_dirichlet(coarse, *start, {}, progress_).uv;
            const Pairs pairs = overlapping_pairs(disk, uv, tolerance_);
            if (!pairs.empty() && surface_.face_count() > tuning.most_polished_faces)
                if (auto apart = push_apart(coarse, disk, uv, pairs, tolerance_, progress_,
                                            tuning.coarse_gap))
                    uv = std::move(*apart);
            return uv;
        };
        std::vector<Vec2> uv = flatten_multilevel(mesh_, surface_, problem_, solve, progress_);
        if (count_flips(problem_, uv) > 0)
            return std::nullopt;
        return uv;
    }

    std::optional<Map> least_strain() const {
        auto map = attempt([&] {
            return least_strain_map(problem_, surface_, tolerance_, SewingMapOptions{}, progress_);
        });
        if (!map)
            return std::nullopt;
        return Map{std::move(map->uv), true, map->pushed};
    }

    // Keeps the lengths of boundary edges and evens out areas. Where no map for sewing is found,
    // the angles are those of the nearest isometric map, whatever the areas.
    std::optional<Map> length_preserving() const {
        if (!problem_.holes.empty())
            return length_preserving_around_holes();
        if (auto sewn = sewing_map(problem_, surface_, tolerance_, SewingMapOptions{}, progress_))
            return Map{std::move(sewn->uv)};
        auto map = isometric();
        if (!map)
            return std::nullopt;
        open_closed_slits(mesh_, surface_, slit_gap * problem_.model_size, map->uv);
        const std::vector<double> angles = boundary_angles(problem_, map->uv);
        auto near = settle_lpfb(problem_, flatten_lpfb(problem_, angles, LpfbOptions{}, progress_),
                                progress_);
        if (!near)
            return std::nullopt;
        return Map{std::move(near->uv), map->converged};
    }

    // LPFB closes one boundary. Holes that lie flat nearly keep their lengths anyway: the nearest
    // isometric map gets them back.
    std::optional<Map> length_preserving_around_holes() const {
        const auto map = isometric();
        if (!map)
            return std::nullopt;
        auto uv = restore_seam_lengths(problem_, map->uv, progress_);
        if (!uv || count_flips(problem_, *uv) > 0)
            return std::nullopt;
        return Map{std::move(*uv), map->converged};
    }

    const Mesh& mesh_;
    const ChartSurface& surface_;
    const FlatteningProblem& problem_;
    double tolerance_;
    const WholeChart* whole_;
    const Progress& progress_;
};

// The half-edges of the mesh along a short path that takes overlapping faces apart.
std::vector<HalfEdge> cut_between(const Mesh& mesh, const ChartSurface& surface, const Pairs& pairs,
                                  bool at_folds) {
    std::vector<HalfEdge> cut;
    if (!pairs.empty())
        for (const HalfEdge h : separating_path(mesh, surface, pairs, Progress(), at_folds))
            cut.push_back(surface.mesh_half_edge(h));
    return cut;
}

// A short cut between the first face and the one that is most faces away.
std::vector<HalfEdge> halve(const Mesh& mesh, const ChartSurface& surface) {
    if (surface.face_count() < 2)
        throw NumericalFailure(
            "expected a map without flipped faces, found none for a single face");
    std::vector<std::uint8_t> seen(surface.face.size(), 0);
    std::vector<Face> reached{0};
    seen[0] = 1;
    for (std::size_t i = 0; i < reached.size(); ++i)
        for (const HalfEdge h : half_edges_of(reached[i])) {
            const HalfEdge twin = surface.twin[h];
            if (twin >= 0 && seen[face_of(twin)] == 0) {
                seen[face_of(twin)] = 1;
                reached.push_back(face_of(twin));
            }
        }
    // A third of the faces on each side takes part, so that the cut is near the middle.
    Pairs pairs{{reached.front(), reached.back()}};
    for (std::size_t i = 0; i < reached.size() / 3; ++i)
        pairs.emplace_back(reached[i], reached[reached.size() - 1 - i]);
    return cut_between(mesh, surface, pairs, false);
}

// An isometric map is no longer than half of its boundary.
bool is_blown_up(const FlatteningProblem& problem, const std::vector<Vec2>& uv) {
    double boundary = 0.0;
    for (const double length : problem.boundary_edge)
        boundary += length;
    return !(plane::box_of(uv).diagonal().norm() <=
             tuning.blown_up * (boundary + std::sqrt(problem.total_area)));
}

// The way of one chart from its surface to a finished map.
class OneChart {
public:
    OneChart(const Mesh& mesh, FlattenMethod method, FlatChart& chart, const Progress& progress,
             const WholeChart* whole)
        : mesh_(mesh), method_(method), chart_(chart), surface_(chart.surface),
          problem_(make_flattening_problem(mesh, chart.surface)),
          tolerance_(plane::layout_tolerance(problem_.model_size)), progress_(progress),
          whole_(whole), flattening_(mesh, surface_, problem_, whole, progress) {}

    /// What is to be cut, see flatten_one.
    std::vector<HalfEdge> flatten() {
        if (develop(mesh_, problem_, chart_)) // stays as it is: its parts are not pushed apart
            return tear(deep_overlaps());
        const bool has_holes = !problem_.holes.empty();
        const auto open = [&] { return open_holes(mesh_, surface_, progress_); };
        auto map = flattening_.map(method_);
        if (!map && has_holes &&
            (method_ == FlattenMethod::lpfb || method_ == FlattenMethod::lpfb_even_areas))
            return tear(open);
        if (!map && method_ != FlattenMethod::symmetric_dirichlet) {
            chart_.mended = true;
            map = flattening_.map(FlattenMethod::symmetric_dirichlet);
        }
        if (!map || (surface_.face_count() > 1 && is_blown_up(problem_, map->uv))) {
            if (has_holes)
                return tear(open);
            return tear([&] { return halve(mesh_, surface_); }); // the halves are easier
        }
        Pairs pairs = take(*map);
        if (may_push(pairs))
            pairs = push(pairs);
        if (may_push(pairs) && whole_ == nullptr)
            pairs = push_coarse(pairs);
        return tear(pairs);
    }

private:
    template <class FindCut>
    std::vector<HalfEdge> tear(FindCut find_cut) {
        chart_.torn = whole_ != nullptr;
        return chart_.torn ? std::vector<HalfEdge>() : find_cut();
    }
    std::vector<HalfEdge> tear(const Pairs& pairs) {
        if (pairs.empty())
            return {};
        return tear([&] { return cut_between(mesh_, surface_, pairs, chart_.developed); });
    }

    Pairs overlaps() const { return overlapping_pairs(surface_, chart_.uv, tolerance_); }

    // Those that paper shows, if there are any: what is left once they are apart may need no cut.
    Pairs deep_overlaps() const {
        Pairs deep = overlapping_pairs(surface_, chart_.uv, slit_gap * problem_.model_size);
        return deep.empty() ? overlaps() : deep;
    }

    Pairs take(const Map& map) {
        chart_.uv = map.uv;
        chart_.converged = map.converged;
        chart_.pushed = map.pushed;
        restore_needles(problem_, chart_.uv);
        finish();
        return overlaps();
    }

    void finish() {
        open_closed_slits(mesh_, surface_, slit_gap * problem_.model_size, chart_.uv);
        chart_.energy = symmetric_dirichlet_energy(problem_, chart_.uv);
    }

    // Pushing moves the whole map towards the least symmetric Dirichlet energy: other methods' maps
    // would not be theirs any more.
    bool may_push(const Pairs& pairs) const {
        return !pairs.empty() && (method_ == FlattenMethod::symmetric_dirichlet || chart_.mended) &&
               surface_.face_count() <= tuning.most_polished_faces &&
               (whole_ == nullptr || whole_->push_apart) && flattening_.is_good(chart_.uv);
    }

    // What still overlaps.
    Pairs push(const Pairs& pairs) {
        const auto apart = push_apart(problem_, surface_, chart_.uv, pairs, tolerance_, progress_);
        if (!apart)
            return pairs;
        chart_.pushed = true;
        // Peaks and slits that close again may need room that pushing has left to other parts.
        for (const bool relieved : {true, false}) {
            chart_.uv = *apart;
            if (relieved)
                relieve_peaks(problem_, true, chart_.uv, progress_);
            finish();
            if (!overlaps_itself(surface_, chart_.uv, tolerance_))
                return {};
        }
        return overlaps();
    }

    // Parts of a large chart that do not come apart on all faces may do so on fewer.
    Pairs push_coarse(const Pairs& pairs) {
        const auto uv = map_by_coarse(mesh_, surface_, problem_, progress_);
        return uv ? take({*uv, true, true}) : pairs;
    }

    const Mesh& mesh_;
    FlattenMethod method_;
    FlatChart& chart_;
    const ChartSurface& surface_;
    FlatteningProblem problem_;
    double tolerance_;
    const Progress& progress_;
    const WholeChart* whole_;
    ChartFlattening flattening_;
};

} // namespace

std::vector<HalfEdge> open_holes(const Mesh& mesh, const ChartSurface& surface,
                                 const Progress& progress) {
    std::vector<HalfEdge> cut;
    for (const HalfEdge h : atlas::join_loops(mesh, surface, {}, progress))
        cut.push_back(surface.mesh_half_edge(h));
    return cut;
}

namespace {

// Slits whose sides lie on each other by less than paper shows are opened by as little: cutting off
// a face for that would make a speck.
void part_closed_slits(const Mesh& mesh, const FlatteningProblem& problem, FlatChart& chart) {
    const double unseen = slit_gap * problem.model_size;
    const auto overlaps = [&](const std::vector<Vec2>& uv, double tolerance) {
        return overlaps_itself(chart.surface, uv, tolerance);
    };
    const double tolerance = plane::layout_tolerance(problem.model_size);
    if (!overlaps(chart.uv, tolerance) || overlaps(chart.uv, unseen))
        return;
    for (double gap = tolerance; gap < 2.0 * unseen; gap *= 2.0) {
        std::vector<Vec2> uv = chart.uv;
        open_closed_slits(mesh, chart.surface, std::min(gap, unseen), uv);
        if (!overlaps(uv, tolerance)) {
            chart.uv = std::move(uv);
            return;
        }
    }
}

} // namespace

bool develop(const Mesh& mesh, const FlatteningProblem& problem, FlatChart& chart) {
    auto development = unfold(problem);
    // Exact angles of many vertices add up to gaps that paper does not show.
    if (!development && largest_defect(problem) <= exact_angle)
        development = unfold(problem, slit_gap);
    if (!development)
        return false;
    chart.uv = std::move(*development);
    scale_to_area(problem, chart.uv);
    // Slits are opened only where readers that take a tenth of the gap for rounding would see other
    // loops.
    const double gap = slit_gap * problem.model_size;
    if (closed_slits_hide_loops(mesh, chart.surface, 0.1 * gap, chart.uv))
        open_closed_slits(mesh, chart.surface, gap, chart.uv);
    part_closed_slits(mesh, problem, chart);
    chart.developed = true;
    chart.energy = symmetric_dirichlet_energy(problem, chart.uv);
    return true;
}

std::vector<HalfEdge> flatten_one(const Mesh& mesh, FlattenMethod method, FlatChart& chart,
                                  const Progress& progress, const WholeChart* whole) {
    return OneChart(mesh, method, chart, progress, whole).flatten();
}

} // namespace devseg::flatten
