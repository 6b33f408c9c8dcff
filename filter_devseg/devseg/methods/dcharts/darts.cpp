#include "devseg/methods/dcharts/darts.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

#include "devseg/atlas/border_path.h"
#include "devseg/base/parallel.h"

namespace devseg::dcharts {

namespace {

constexpr std::size_t tried_spots = 3;  // of a chart, for each dart
constexpr double worst_spot_gain = 0.1; // share of the excess over the bound that a dart must take

struct Dart {
    std::vector<Index> path; // half-edges of the mesh
    Index tip = -1;          // vertex of the mesh
    judge::TrialMap map;     // of the chart with the dart
    double length = 0.0;
};

// The corner of a face around which the surface bends most: where a cone's tip would be.
Index sharpest_corner(const Mesh& mesh, Face face) {
    Index best = -1;
    double largest = -1.0;
    for (const HalfEdge h : half_edges_of(face)) {
        double angles = 0.0;
        const bool inner = mesh::visit_star(mesh, h, [&](Index k) {
            const Vec3 a = mesh.points[mesh.target(k)] - mesh.points[mesh.origin(k)];
            const Vec3 b =
                mesh.points[mesh.origin(Mesh::previous(k))] - mesh.points[mesh.origin(k)];
            angles += std::atan2(a.cross(b).norm(), a.dot(b));
        });
        const double defect = inner ? std::abs(2.0 * pi - angles) : 0.0;
        if (defect > largest) {
            largest = defect;
            best = mesh.origin(h);
        }
    }
    return best;
}

// One chart's darts; the cuts of other charts do not matter.
class DartCutter {
public:
    DartCutter(const Mesh& mesh, const DartOptions& options, const std::vector<Index>& faces,
               std::vector<std::uint8_t> seam, judge::TrialMap map, const Progress& progress)
        : mesh_(mesh), options_(options), faces_(faces), seam_(std::move(seam)),
          map_(std::move(map)), progress_(progress) {}

    std::vector<Dart> run() {
        std::vector<Dart> darts;
        while (static_cast<int>(darts.size()) < options_.max_per_chart && map_.flat &&
               !options_.chart.hold(map_)) {
            progress_.check();
            Dart best = find_best();
            if (best.path.empty())
                break;
            atlas::mark_cuts(mesh_, best.path, seam_);
            map_ = best.map;
            darts.push_back(std::move(best));
        }
        return darts;
    }

private:
    Dart find_best() {
        Dart best;
        double highest = 0.0;
        for (std::size_t i = 0; i < std::min(tried_spots, map_.worst_faces.size()); ++i) {
            Dart dart;
            dart.tip = sharpest_corner(mesh_, map_.worst_faces[i]);
            dart.path = atlas::path_to_border(mesh_, faces_, seam_, dart.tip);
            if (dart.path.empty())
                continue;
            for (const HalfEdge h : dart.path)
                dart.length += mesh_.edge_length(h);
            std::vector<std::uint8_t> seam = seam_;
            atlas::mark_cuts(mesh_, dart.path, seam);
            judge::TrialEffort effort;
            effort.wanted_l2 = options_.chart.l2;
            dart.map = judge::try_chart(mesh_, faces_, seam, effort, progress_);
            const double value = worth(dart);
            if (value > highest) {
                highest = value;
                best = std::move(dart);
            }
        }
        return best;
    }

    // What the dart gains for each unit of length; 0 where it is not worth cutting.
    double worth(const Dart& dart) const {
        if (!dart.map.flat || (dart.map.overlaps && !map_.overlaps))
            return 0.0;
        const double root = std::sqrt(mesh_.total_area);
        const double gain =
            (map_.excess() - dart.map.excess()) / mesh_.total_area / (dart.length / root);
        const double above = map_.linf - options_.chart.linf;
        // Of several spots above the bound, a dart takes one.
        const double lower =
            map_.peaks_above(options_.chart.linf) - dart.map.peaks_above(options_.chart.linf);
        if (above > 0.0 && lower > worst_spot_gain * above)
            return std::max(gain, 0.0) + options_.worth * lower / above;
        return gain >= options_.worth ? gain : 0.0;
    }

    const Mesh& mesh_;
    const DartOptions& options_;
    const std::vector<Index>& faces_;
    std::vector<std::uint8_t> seam_;
    judge::TrialMap map_;
    const Progress& progress_;
};

} // namespace

Index cut_darts(const Mesh& mesh, const DartOptions& options, Draft& draft, Progress& progress) {
    std::vector<std::vector<Dart>> darts(draft.faces.size());
    parallel_for(
        static_cast<int>(draft.faces.size()),
        [&](int i) {
            const std::size_t c = static_cast<std::size_t>(i);
            if (!draft.faces[c].empty() && !options.chart.hold(draft.map[c]))
                darts[c] =
                    DartCutter(mesh, options, draft.faces[c], draft.seam, draft.map[c], progress)
                        .run();
        },
        progress);
    Index count = 0;
    for (std::size_t c = 0; c < darts.size(); ++c)
        for (const Dart& dart : darts[c]) {
            atlas::mark_cuts(mesh, dart.path, draft.seam);
            draft.tips.push_back(dart.tip);
            draft.map[c] = dart.map;
            ++count;
        }
    return count;
}

Index cut_darts_to(const Mesh& mesh, const std::vector<Index>& chart,
                   const std::vector<Index>& tips, std::vector<std::uint8_t>& seam) {
    if (tips.empty())
        return 0;
    std::vector<Index> leaving(mesh.points.size(), -1);
    for (const HalfEdge h : mesh.all_half_edges())
        leaving[mesh.origin(h)] = h;
    Index cuts = 0;
    for (const Index tip : tips) {
        const Index label = chart[leaving[tip] / 3];
        std::vector<Index> faces;
        for (const Face f : mesh.all_faces())
            if (chart[f] == label)
                faces.push_back(f);
        const std::vector<Index> path = atlas::path_to_border(mesh, faces, seam, tip);
        atlas::mark_cuts(mesh, path, seam);
        cuts += path.empty() ? 0 : 1;
    }
    return cuts;
}

} // namespace devseg::dcharts
