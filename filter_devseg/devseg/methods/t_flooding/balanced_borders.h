// Short borders between charts that keep the charts' Gauss areas in balance.
#pragma once

#include <vector>

#include "devseg/base/progress.h"
#include "devseg/mesh/flat_regions.h"
#include "devseg/metrics/gauss_area.h"

namespace devseg::t_flooding {

struct BorderBalance {
    int sweeps = 6;            // over all pairs of neighbours
    double reach = 0.2;        // how far borders may move in one sweep, share of the charts' depth
    double crease_cost = 0.05; // cost of a border along a crease, share of its length
    double stiffness = 30.0;   // weight of balance against length, without unit
};

/// Lowers the borders' length plus κ/2 times the sum of the charts' squared Gauss areas, where κ is
/// the stiffness times the size of an average chart over its squared Gauss area. For each two
/// neighbours in turn: the least cut within a strip along their border, with a price on Gauss area
/// that agrees with the difference that is left. Charts stay connected and keep their topology.
/// `chart` (#F) holds labels 0 … count − 1. Facets that are in one chart stay whole.
void balance_borders(const Mesh& mesh, const metrics::GaussAreas& areas, const mesh::Facets& facets,
                     const BorderBalance& options, Index count, std::vector<Index>& chart,
                     Progress& progress);

} // namespace devseg::t_flooding
