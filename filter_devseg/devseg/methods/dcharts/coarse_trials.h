// Trials of closings on a coarse version of the surface, on which all borders and cuts are lines
// that stay: much cheaper than on the surface itself, which has the last word.
#pragma once

#include <optional>
#include <vector>

#include "devseg/mesh/coarsen.h"
#include "devseg/methods/dcharts/seam_chains.h"

namespace devseg::dcharts {

class CoarseTrials {
public:
    /// Of the draft's charts, all of which are tried; the stretch is to be compared with
    /// `wanted_l2`. Vertices marked in `fixed` (#V) stay.
    CoarseTrials(const Mesh& mesh, const Draft& draft, const std::vector<std::uint8_t>& fixed,
                 double wanted_l2, Progress& progress);

    /// The map of a chart as it is, and that of a joined one. `seam`: 3 #F of the surface, what is
    /// left of cuts. The closing opens nothing and ends at vertices that the coarse surface has.
    /// Starts from `turns` of the joined map, or, without, from the maps of the charts.
    const judge::TrialMap& map(Index chart) const { return draft_.map[chart]; }
    judge::TrialMap try_closing(const Closing& closing, const std::vector<std::uint8_t>& seam,
                                const judge::TrialEffort& effort, std::vector<Vec2> turns,
                                const Progress& progress) const;
    bool has(Vertex v) const { return has_[v] != 0; }

    void close(const Pair& charts, judge::TrialMap map);

    /// Whether they are worth it.
    static bool pay(const Mesh& mesh, const Draft& draft);

private:
    mesh::CoarseMesh coarse_;
    std::vector<std::uint8_t> has_; // #V of the surface
    std::vector<Index> edge_;       // 3 #F of the surface: half-edge of the coarse one, or −1
    Draft draft_;                   // of the coarse surface; its seams are not kept
};

/// Faces of both charts, ascending; `charts` may be twice the same.
std::vector<Index> united_faces(const Draft& draft, const Pair& charts);

} // namespace devseg::dcharts
