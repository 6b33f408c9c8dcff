// Borders between charts: finding them, and making them straight [JKS05, section 3.3].
//
// References
//   [BVZ01] Y. Boykov, O. Veksler, R. Zabih: Fast Approximate Energy Minimization via Graph Cuts.
//           IEEE PAMI 23(11), 2001. doi:10.1109/34.969114
//   [JKS05] D. Julius, V. Kraevoy, A. Sheffer: D-Charts: Quasi-Developable Mesh Segmentation.
//           Computer Graphics Forum 24(3), 2005. doi:10.1111/j.1467-8659.2005.00883.x
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/mesh.h"
#include "devseg/metrics/conic_proxy.h"

namespace devseg::growth {

/// A piece of the border between two charts: from one junction to the next, or a whole loop. A
/// junction is a vertex where three charts meet, or where the border reaches the mesh's boundary.
struct BorderSegment {
    Index chart_a = 0;             // the chart on the left
    Index chart_b = 0;             // the chart on the right
    std::vector<Index> half_edges; // of chart a, head to tail
    bool is_loop = false;
};

std::vector<BorderSegment> find_border_segments(const Mesh& mesh, const std::vector<Index>& chart);

/// What faces may fit in each chart: one proxy, or several for charts that were joined.
using ChartProxies = std::vector<std::vector<metrics::ConicProxy>>;

/// Replaces each border by the shortest path between its ends, or the shortest loop around it,
/// within the fuzzy area of its two charts: the faces near the border that fit both proxies better
/// than `max_fitting_error`, at most `rings` faces away from it (0: any number). A border stays as
/// it is where a new one would take a chart apart or change its number of boundary loops. Returns
/// the number of borders that were replaced.
Index straighten_borders(const Mesh& mesh, const ChartProxies& proxies, double max_fitting_error,
                         int rings, std::vector<Index>& chart, Progress& progress);

// Borders as the least cut: which chart each face fits, against how long the borders become. Takes
// the place of straightening border by border where junctions should move as well.

struct ExpansionOptions {
    double max_fitting_error = 0.2; // F_max: faces above it pay many times over
    double length_weight = 0.02;    // of borders, against the fitting error of the faces
    int max_rounds = 4;             // over all charts; proxies are fitted again after each
};

/// Lowers Σ A_f F(C_f, f) + w √A Σ l_e over the labels, with l_e the lengths of border edges, those
/// along creases counting less, by expansion moves [BVZ01]: each chart in turn takes all the faces
/// that lower the sum. `chart` is #F, 0 … proxies − 1; charts may fall apart or vanish.
void relabel_by_expansion(const Mesh& mesh, std::vector<metrics::ConicProxy> proxies,
                          const ExpansionOptions& options, std::vector<Index>& chart,
                          Progress& progress);

} // namespace devseg::growth
