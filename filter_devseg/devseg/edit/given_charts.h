// Charts from edges that somebody chose.
#pragma once

#include <cstdint>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"

namespace devseg::edit {

/// Marks (3 #F, symmetric) of the edges between faces with and without a flag (#F).
std::vector<std::uint8_t> borders_of(const Mesh& mesh, const std::vector<std::uint8_t>& flags);

struct CompletedCuts {
    std::vector<std::uint8_t> seam; // 3 #F
    Index completed = 0;            // loose ends that were led to a cut or to the border
    Index loose = 0;                // ends that nothing lies ahead of
};

/// Leads every end of a cut that lies inside the surface on to another cut, to the mesh's border,
/// or to the other end of the same cut: by the shortest path ahead of it, on which creases count
/// less (atlas::crease_factor). What lies beside the cut, nearer to it than to its end, is not
/// ahead. `seam` is 3 #F, symmetric.
CompletedCuts complete_cuts(const Mesh& mesh, std::vector<std::uint8_t> seam,
                            const Progress& progress);

} // namespace devseg::edit
