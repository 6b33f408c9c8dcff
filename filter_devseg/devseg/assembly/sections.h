// Pieces → sections that are made by themselves: limbs, and what they are attached to.
#pragma once

#include <vector>

#include "devseg/pattern/pattern.h"

namespace devseg::assembly {

/// What pieces have in common.
struct PieceGraph {
    explicit PieceGraph(const pattern::Pattern& pattern);

    Index piece_count = 0;
    std::vector<double> area;            // mm²
    std::vector<std::vector<double>> mm; // length of the seams between two pieces; 0 = none
    std::vector<Index> component;        // of each piece: what hangs together
    Index component_count = 0;
    // Of each component: whether it is a solid, up to holes that are small beside it, as scans have
    // them; and the volume of solids, with flat lids on such holes, mm³.
    std::vector<std::uint8_t> is_closed;
    std::vector<double> volume;

private:
    void measure_solids(const pattern::Pattern& pattern);
};

/// Sections, 0, 1, …: the union of two that is most closed is made, again and again, where closed
/// means a short border beside its area: P² / 4πA, 1 for a disk, far less for a tube with a short
/// neck. Unions that are as closed as a limb grow no further. What is left and touches fewer than
/// three sections joins the one that it shares the longest seams with.
std::vector<Index> find_sections(const PieceGraph& graph);

} // namespace devseg::assembly
