// What a segmentation costs and how developable its charts are, before anything is flattened.
//
// References
//   [YGZS05] H. Yamauchi, S. Gumhold, R. Zayer, H.-P. Seidel: Mesh Segmentation Driven by Gaussian
//            Curvature. The Visual Computer 21, 2005. doi:10.1007/s00371-005-0319-x
#pragma once

#include "devseg/atlas/charts.h"

namespace devseg::metrics {

struct SegmentationMeasures {
    Index charts_number = 0;
    Index disk_charts_number = 0;   // V − E + F = 1 and one boundary loop, darts cut open
    Index holed_charts_number = 0;  // disks but for holes that lie flat with them
    double gauss_area_std = 0.0;    // standard deviation of the charts' Gauss areas [YGZS05,
                                    // equation 3], creases from 45 degrees on, steradians
    double gauss_area_mean = 0.0;   // their mean, steradians
    double crease_share = 1.0;      // share of the length of these creases that is cut, 0 to 1
    double max_fitting_error = 0.0; // largest D-Charts error of a face in its chart's best conic
    double seam_length = 0.0;       // of all cut edges, each counted once, model units
    double largest_chart_area_share = 0.0; // of the surface, 0 to 1
};

SegmentationMeasures measure_segmentation(const Mesh& mesh, const atlas::ChartMap& charts);

/// Length of all cut edges, each counted once, model units. The mesh's own boundary is no seam.
double seam_length(const Mesh& mesh, const atlas::ChartMap& charts);

} // namespace devseg::metrics
