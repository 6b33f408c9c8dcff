// Pieces → sections that are made by themselves: limbs, and what they are attached to.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "devseg/base/progress.h"
#include "devseg/pattern/pattern.h"

namespace devseg::assembly {

/// What pieces have in common.
struct PieceGraph {
    explicit PieceGraph(const pattern::Pattern& pattern);

    Index piece_count = 0;
    std::vector<double> area; // mm²
    // Of each piece: the pieces that it has seams with, and the length of those, mm. Models of
    // thousands of pieces have few seams each.
    std::vector<std::map<Index, double>> mm;
    std::vector<Index> component; // of each piece: what hangs together
    Index component_count = 0;
    // Of each component: whether it is a solid, up to holes that are small beside it, as scans have
    // them; and the volume of solids, with flat lids on such holes, mm³.
    std::vector<std::uint8_t> is_closed;
    std::vector<double> volume;

    /// Length of the seams between two pieces, mm; 0 = none.
    double shared(Index a, Index b) const {
        const auto found = mm[at(a)].find(b);
        return found == mm[at(a)].end() ? 0.0 : found->second;
    }

private:
    void measure_solids(const pattern::Pattern& pattern);
};

/// The section that each piece is made in.
struct Grouping {
    std::vector<Index> section;        // of each piece: any number that its section shares
    std::vector<std::uint8_t> is_body; // of each piece: 1 = limbs are joined to its section
};

/// By what pieces have in common: the union of two sections that is most closed is made, again and
/// again, where closed means a short border beside its area: P² / 4πA, 1 for a disk, far less for a
/// tube with a short neck. Unions that are as closed as a limb grow no further. What is left and
/// touches fewer than three sections joins the one that it shares the longest seams with. Throws
/// Cancelled.
Grouping group_by_seams(const PieceGraph& graph, const Progress& progress);

/// The same where a part is no solid, or has no limb (limbs.h) with a piece of its own. Else each
/// piece is of the limb that holds most of it, or of the body. Throws Cancelled.
Grouping group_by_limbs(const pattern::Pattern& pattern, const PieceGraph& graph,
                        const Progress& progress);

} // namespace devseg::assembly
