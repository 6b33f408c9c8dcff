// Borders between charts as the least cut: which chart each face fits, against how long the borders
// become. Takes the place of straightening border by border where junctions should move as well.
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
