// A segmentation while it is being improved, every chart with its trial map; and what takes charts
// apart: splits and darts [JKS05, section 3.3].
//
// References
//   [JKS05] D. Julius, V. Kraevoy, A. Sheffer: D-Charts: Quasi-Developable Mesh Segmentation.
//           Computer Graphics Forum 24(3), 2005. doi:10.1111/j.1467-8659.2005.00883.x
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/judge/trial.h"
#include "devseg/mesh/mesh.h"
#include "devseg/methods/dcharts/dcharts.h"

namespace devseg::dcharts {

struct Draft {
    std::vector<Index> chart;       // #F
    std::vector<std::uint8_t> seam; // 3 #F, symmetric: cuts inside charts
    std::vector<Index> tips;        // vertices where darts end, in the order of cutting
    std::vector<HalfEdge> left;     // cuts that joins left inside charts; some may be healed since
    std::vector<std::vector<Index>>
        faces;                        // of each chart, ascending; empty for charts that are gone
    std::vector<judge::TrialMap> map; // of each chart
    Index joins = 0;                  // of two charts each, so far

    Index charts_number() const;
    double excess() const; // Σ A (l2² − 1) over the charts, internal units squared
};

/// Labels of edge-connected charts and cuts inside them (3 #F, empty for none) → a draft, all
/// charts tried; the stretch is to be compared with `wanted_l2`.
Draft make_draft(const Mesh& mesh, const std::vector<Index>& chart,
                 const std::vector<std::uint8_t>& seam, double wanted_l2, Progress& progress);

/// The same without trials, for a segmentation that stays as it is.
Draft make_untried_draft(const Mesh& mesh, const std::vector<Index>& chart);

/// Stretch that a chart should not exceed.
struct StretchBounds {
    double l2 = 1.005;
    double linf = 1.5;
    double hard_l2 = infinite;   // what not even a small chart may exceed
    double hard_linf = infinite; // the same of linf
    double strain = infinite;    // of 99 % of the area; twice as much anywhere

    bool hold(const judge::TrialMap& map) const {
        return map.l2_squared <= l2 * l2 && map.linf <= linf && keep_strain(map);
    }
    bool keep_strain(const judge::TrialMap& map) const {
        return map.strain.most_of_it <= strain && map.strain.worst <= 2.0 * strain;
    }
};

/// The faces of a chart as a mesh of their own, in their order.
Mesh mesh_of_chart(const Mesh& mesh, const std::vector<Index>& faces);

/// Grows two D-Charts within the chart, far from each other, and gives the second and what it left
/// over labels of their own. Cuts inside the chart are healed. Returns whether the chart is in
/// parts now; false for a single face.
bool split_chart(const Mesh& mesh, const DChartsOptions& options, double wanted_l2, Index chart,
                 Draft& draft, Progress& progress);

/// The same with the two parts that two planes fit best, where one cone fits all of the chart but
/// for a few faces.
bool halve_chart(const Mesh& mesh, double wanted_l2, Index chart, Draft& draft, Progress& progress);

struct DartOptions {
    StretchBounds chart; // darts are cut while a chart is above them
    double worth = 1e-3; // least drop of Σ A (l2² − 1), as a share of the surface's area, for
                         // each √area of length, for a dart that does not lower the worst spot
    int max_per_chart = 12; // darts
};

/// Cuts darts into the charts that exceed the bounds, each along a short path from the border, or
/// from another dart, to the spot where that helps most; stops where no dart is worth its length.
/// Returns the number of darts.
Index cut_darts(const Mesh& mesh, const DartOptions& options, Draft& draft, Progress& progress);

/// Cuts from each of the vertices, in order, to the border of its chart or to an earlier cut; a
/// vertex on a border needs none. `seam` is 3 #F. Returns the number of cuts.
Index cut_darts_to(const Mesh& mesh, const std::vector<Index>& chart,
                   const std::vector<Index>& tips, std::vector<std::uint8_t>& seam);

} // namespace devseg::dcharts
