// The numbers of D-Charts, and why they have these values.
#pragma once

#include <array>

#include "devseg/mesh/mesh.h"

namespace devseg::dcharts {

struct Tuning {
    // Growth

    // [JKS05] stops when fewer faces than this change their chart between two rounds.
    double converged_share = 0.05;
    // [JKS05] looks at the k faces with the smallest fitting error for the next seed.
    Index seed_candidates = 10;
    // On planes and cylinders F is 0 and the product cost would ignore compactness. The floor is
    // the error of a normal that leans 1 degree against a cylinder's: less is within the noise of
    // meshes.
    double fitting_error_floor = 3e-4;
    // A hole below this share of the average chart's area is filled by its neighbours; a larger one
    // gets charts of its own [JKS05, section 3.2, which gives no number].
    double small_hole_share = 0.25;

    // Joins, splits and darts

    // Stretch that equal lengths of border are worth when two joins cost next to nothing: a share
    // of the area for each √area of border.
    double negligible = 1e-5;     // and of √area: a cut of this length is none
    double small_allowance = 3.0; // of small charts, over the bounds of others
    double like_spot = 1.1;       // stretch over that of the parts' worst spots that is like theirs
    // Angle defect, in radians, of vertices at which the surface has a corner: seams may be closed
    // up to one.
    double corner_defect = 0.2;
    double least_part = 0.1;       // of a border, over √area, that is closed on its own
    std::size_t tried_again = 4;   // parts at a time, the best of those with old verdicts
    std::size_t tried_at_once = 8; // closings, before the best of them makes others needless
    // Parts between creases, joined one by one. Where there are more, creases are no guide.
    Index most_regions = 1000;
    Index few_regions = 100;      // flat faces of such a part that are joined one by one
    double smallest_part = 0.05;  // of a chart: smaller parts are not worth a chart
    std::size_t tried_spots = 3;  // of a chart, for each dart
    double worst_spot_gain = 0.1; // share of the excess over the bound that a dart must take

    // Decimation

    Index decimated_faces = 6000;          // enough to decide where borders run
    Index decimated_creased_faces = 24000; // where they must run along creases
    Index faces_per_chart = 150;           // of the coarse surface, at least
    double worth_decimation = 2.0;         // faces over those of the coarse surface
    Index trial_faces = 3000;              // of the surface on which joins are tried, at least,
    Index trial_faces_per_chart = 100;     // and for each chart,
    double coarse_slack = 2.0;             // of the bound of l2² − 1 there: creases are coarser
    double trial_share = 0.06;             // and of all faces
    double rough = 0.002; // l2² − 1 of small neighbourhoods: less is tessellation
    // Strain of 99 % of a rough surface over the root of its l2² − 1, which is about the mean of
    // squared strains: as of a normal distribution.
    double rough_tail = 2.6;
    double least_chart = 0.002; // of the surface: less are slivers nobody wants to cut out

    // What border is worth against the fitting error of faces.
    double smooth_length_weight = 0.045;

    // Where creases shape the surface, its parts are cones, cylinders and planes but for the
    // tessellation: charts must fit them closely, borders belong on creases whatever their length,
    // and joins must be nearly exact.
    double creased_fitting_error = 0.008; // F_max at most
    double creased_length_weight = 0.001;
    double creased_threshold = 0.02; // factor of η
    double creased_neck = 0.1;       // least hinge of two parts of a net, see MergeOptions
    double bent_cosine = 0.866;      // of 30 degrees
    double sharp_edge_cosine = 0.5;  // of 60 degrees
    double sharp_share = 0.6;        // of the bent edges

    // The number of charts

    Index few_seeds = 3;        // twice as many are tried where they give more charts than wanted
    Index automatic_seeds = 10; // where the number of charts is to be found
    int most_splits = 200;
    double room_for_joins = 0.6; // of the allowed stretch: splitting goes below it
    // Of a chart's bound, that its map may use: flattening may give it slivers of its neighbours.
    double certain = 0.95;
    int few_darts = 4; // of a chart above its bound; then it is split
    // Of the allowed stretch, that the coarse surface may use, one after the other: the final map
    // has a little more or less, and has the last word.
    std::array<double, 3> shares{0.8, 0.9, 1.0};
    double chart_excess = 4.0; // of one chart over that of the whole
    double loose_linf = 8.0;   // worst spots count little where they have no bound
};
inline constexpr Tuning tuning;

} // namespace devseg::dcharts
