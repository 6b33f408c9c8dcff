// Seams for plush toys: patches that lie flat, with seams where people expect them.
//
// References
//   [Plush] An appearance-aware seam method for plush toys; title and authors are lost in our copy.
//           See docs/methods/plush.md.
//   [Wan08], [BGB08], [TAOZ12], [BP07]: see the headers of the steps.
#pragma once

#include <string>

#include "devseg/atlas/charts.h"
#include "devseg/base/option_checks.h"
#include "devseg/base/progress.h"
#include "devseg/flatten/energy/strain.h"
#include "devseg/methods/plush/seam_guides.h"
#include "devseg/methods/plush/skeleton.h"

namespace devseg::plush {

struct PlushOptions {
    double max_area_change = 0.15; // largest change of a face's area, where max_strain is 0
    double max_strain = 0.2; // of 99 % of a patch's area, twice that anywhere; 0: by areas alone
    double geodesic_weight = 0.3;  // α
    double skeleton_weight = 0.3;  // β
    double curvature_weight = 0.8; // γ
    int max_extrema = 0;           // ends of structural seams at most; 0: √#V
    bool symmetric = true;         // keep seams symmetric where the model is
    int random_seed = 0;
    int max_iterations = 10000; // rounds of trials of each way of removing seams

    static OptionRanges<PlushOptions> ranges();
};

struct PlushSeams {
    atlas::ChartMap charts;
    std::vector<double> area_change; // #F: of the accepted maps, |area in the plane / own area − 1|
    double max_area_change = 0.0;
    flatten::Strain strain;    // of the patches' maps, each value that of the worst patch
    std::vector<Index> failed; // charts that do not keep their bound
    bool is_symmetric = false;
    SeamShares shares;
    Index extrema = 0;
    Index bones = 0;
    Index limbs = 0;
    Index candidates = 0; // segments before removal
    Index darts = 0;
    Index trials = 0;
    bool all_developable = true;
};

/// `skeleton`: bones to follow, or empty to find them. `hard` (3 #F or empty): borders between
/// materials, which stay.
PlushSeams segment_plush_seams(const Mesh& mesh, const PlushOptions& options, Skeleton skeleton,
                               const std::vector<std::uint8_t>& hard, Progress& progress);

} // namespace devseg::plush
