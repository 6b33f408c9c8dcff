#include "devseg/judge/cloth.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "devseg/atlas/charts.h"
#include "devseg/atlas/holes.h"
#include "devseg/base/errors.h"
#include "devseg/flatten/energy/area_balance.h"
#include "devseg/flatten/energy/map_tools.h"
#include "devseg/flatten/maps/lpfb_map.h"
#include "devseg/flatten/maps/lscm.h"
#include "devseg/flatten/maps/tutte.h"
#include "devseg/flatten/maps/unfold.h"
#include "devseg/flatten/repair/overlaps.h"
#include "devseg/flatten/repair/slits.h"
#include "devseg/plane/overlap.h"

namespace devseg::judge {

namespace {

struct Tuning {
    double used_bound = 0.98; // share of the bound: maps are rounded to 32 bits later
    // Of the bound: what is asked of the mean of a patch. Cloth that is strained everywhere by what
    // it takes at most is not smooth.
    double mean_strain = 0.28;
    // By areas: L2 stretch above 1 that even areas may cost, 20 % in the mean; half of it in a
    // search.
    double most_shear = 0.04;
    // As-rigid-as-possible energy of patches that are not worth a closer look: by areas, lines
    // change their length by 8 % in the mean. By strain, of the map whose boundary is free, and
    // mean excess of the symmetric Dirichlet energy with seams that keep their lengths.
    double hopeless_energy = 0.012;
    double hopeless_free_energy = 0.006;
    double hopeless_excess = 0.012;
    double hopeless_overlap = 0.03; // pairs of faces over faces, in a nearly isometric map
    // The limits at which these are so; they go with the square of smaller ones.
    double usual_change = 0.1;
    double usual_strain = 0.2;
};
constexpr Tuning tuning;

double square(double x) {
    return x * x;
}

// One patch that is tried.
class Trial {
public:
    Trial(const Mesh& mesh, const atlas::ChartSurface& surface, const ClothLimits& limits,
          const Progress& progress)
        : mesh_(mesh), surface_(surface), limits_(limits), progress_(progress),
          problem_(flatten::make_flattening_problem(mesh, surface)),
          size_(std::sqrt(mesh.total_area)), tolerance_(plane::layout_tolerance(size_)) {}

    ClothTrial run(bool details) const {
        ClothTrial trial;
        trial.is_sound = true;
        const auto uv = limits_.by_strain() ? by_strain(trial) : by_area(trial);
        trial.has_map = uv.has_value();
        if (details)
            describe(uv ? *uv : any_map(), trial);
        return trial;
    }

    ClothTrial conformal() const {
        ClothTrial trial;
        trial.is_sound = true;
        describe(any_map(), trial);
        return trial;
    }

private:
    std::optional<std::vector<Vec2>> by_strain(ClothTrial& trial) const {
        const double bound = tuning.used_bound * limits_.max_strain;
        flatten::SewingMapOptions options;
        if (limits_.is_search) {
            const double share = square(limits_.max_strain / tuning.usual_strain);
            options.give_up_energy = tuning.hopeless_free_energy * share;
            options.give_up_excess = tuning.hopeless_excess * share;
            options.give_up_overlap = tuning.hopeless_overlap;
            options.push_apart = false;
        }
        auto map = flatten::attempt([&] {
            return flatten::least_strain_map(problem_, surface_, tolerance_, options, progress_);
        });
        if (!map)
            return std::nullopt;
        std::optional<std::vector<Vec2>> uv(std::move(map->uv));
        open_slits(*uv);
        trial.area_change = flatten::measure_area_change(problem_, *uv).largest();
        trial.strain = flatten::measure_strain(flatten::face_strains(problem_, *uv), problem_.area);
        trial.accepted = trial.strain.most_of_it <= bound && trial.strain.worst <= 2.0 * bound &&
                         trial.strain.mean <= tuning.mean_strain * bound && is_one_to_one(*uv);
        return uv;
    }

    std::optional<std::vector<Vec2>> by_area(ClothTrial& trial) const {
        const double bound = tuning.used_bound * limits_.max_area_change;
        const double stretch = 1.0 + tuning.most_shear / (limits_.is_search ? 2.0 : 1.0);
        flatten::SewingMapOptions options;
        options.enough = bound;
        options.enough_stretch = stretch;
        if (limits_.is_search) {
            const double strictness = std::min(1.0, limits_.max_area_change / tuning.usual_change);
            options.give_up_energy = tuning.hopeless_energy * strictness * strictness;
            options.give_up_overlap = tuning.hopeless_overlap;
        }
        auto map = flatten::sewing_map(problem_, surface_, tolerance_, options, progress_);
        if (!map)
            return std::nullopt;
        trial.area_change = map->area_change;
        // At the scale at which the map has the patch's area.
        const double l2 =
            map->l2_stretch * std::sqrt(flatten::map_area(problem_, map->uv) / problem_.total_area);
        std::vector<Vec2> open = map->uv;
        open_slits(open);
        trial.accepted = map->area_change <= bound && l2 <= stretch &&
                         flatten::measure_area_change(problem_, open).largest() <= bound &&
                         is_one_to_one(open);
        return std::move(map->uv);
    }

    // As when charts are flattened.
    void open_slits(std::vector<Vec2>& uv) const {
        flatten::open_closed_slits(mesh_, surface_, flatten::slit_gap * size_, uv);
    }

    bool is_one_to_one(const std::vector<Vec2>& uv) const {
        return flatten::overlapping_pairs(surface_, uv, tolerance_).empty();
    }

    // A map of a patch that has none for sewing, good enough to see where its area changes; empty
    // where needles leave none.
    std::vector<Vec2> any_map() const {
        std::vector<Vec2> uv = flatten::attempt([&] { return flatten::flatten_lscm(problem_); });
        if (uv.empty() || flatten::count_flips(problem_, uv) > 0)
            uv = flatten::attempt([&] { return flatten::flatten_tutte(problem_); });
        if (!uv.empty())
            flatten::scale_to_area(problem_, uv);
        return uv;
    }

    void describe(const std::vector<Vec2>& uv, ClothTrial& trial) const {
        if (uv.empty())
            return;
        trial.face = surface_.face;
        for (std::size_t f = 0; f < problem_.faces.size(); ++f)
            trial.change.push_back(flatten::jacobian(problem_, uv, f).determinant() - 1.0);
        if (limits_.by_strain())
            trial.strains = flatten::face_strains(problem_, uv);
    }

    const Mesh& mesh_;
    const atlas::ChartSurface& surface_;
    const ClothLimits& limits_;
    const Progress& progress_;
    const flatten::FlatteningProblem problem_;
    const double size_;
    const double tolerance_;
};

// LPFB keeps one boundary; what unfolds exactly needs no LPFB.
ClothTrial try_holes(const Mesh& mesh, const atlas::ChartSurface& surface) {
    ClothTrial trial;
    if (!atlas::is_sound(mesh, surface))
        return trial;
    const auto uv = flatten::unfold(flatten::make_flattening_problem(mesh, surface));
    const double tolerance = plane::layout_tolerance(std::sqrt(mesh.total_area));
    trial.accepted = trial.is_sound = trial.has_map =
        uv && flatten::overlapping_pairs(surface, *uv, tolerance).empty();
    return trial;
}

} // namespace

ClothTrial try_cloth(const Mesh& mesh, const std::vector<Index>& faces,
                     const std::vector<std::uint8_t>& seam, const ClothLimits& limits, bool details,
                     const Progress& progress) {
    const atlas::ChartSurface surface = atlas::extract_surface(mesh, faces, seam);
    return surface.is_disk() ? Trial(mesh, surface, limits, progress).run(details)
                             : try_holes(mesh, surface);
}

ClothTrial conformal_change(const Mesh& mesh, const std::vector<Index>& faces,
                            const std::vector<std::uint8_t>& seam) {
    const atlas::ChartSurface surface = atlas::extract_surface(mesh, faces, seam);
    return surface.is_disk() ? Trial(mesh, surface, {}, Progress()).conformal() : ClothTrial();
}

std::vector<Index> cut_between_sheets(const Mesh& mesh, const std::vector<Index>& faces,
                                      const std::vector<std::uint8_t>& seam, bool has_map,
                                      const Progress& progress) {
    const atlas::ChartSurface surface = atlas::extract_surface(mesh, faces, seam);
    const double tolerance = plane::layout_tolerance(std::sqrt(mesh.total_area));
    return flatten::attempt([&] {
        const flatten::FlatteningProblem problem = flatten::make_flattening_problem(mesh, surface);
        std::vector<Index> cut;
        const std::vector<Vec2> uv = flatten::nearly_isometric_map(problem, infinite, progress);
        if (uv.empty())
            return cut;
        auto pairs = flatten::overlapping_pairs(surface, uv, tolerance);
        if (pairs.empty() && !has_map)
            pairs = flatten::overlapping_pairs(
                surface, flatten::balance_with_boundary(problem, uv, progress), tolerance);
        if (!pairs.empty())
            for (const HalfEdge h : flatten::separating_path(mesh, surface, pairs, progress))
                cut.push_back(surface.mesh_half_edge(h));
        return cut;
    });
}

} // namespace devseg::judge
