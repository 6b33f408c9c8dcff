// New labels for faces between two charts, taken unless they would change what the charts are.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::growth {

/// A border or an energy is lower than another if it is below this share of it: rounding does not
/// explain that.
constexpr double truly_lower = 1.0 - 1e-9;

/// (face, chart)
using NewLabels = std::vector<std::pair<Index, Index>>;

class Relabelling {
public:
    /// `chart` (#F) is read and changed.
    Relabelling(const Mesh& mesh, std::vector<Index>& chart);

    /// One of the two charts: a face of it before, and one that it has with the new labels (−1
    /// where it would have none).
    struct Side {
        Index chart = 0;
        Face before;
        Face after;
    };
    /// `most_lost` of a chart's faces may go; `may_fill`: a chart may become simpler, up to a disk.
    struct Rule {
        double most_lost = 1.0;
        bool may_fill = false;
    };

    /// Takes the new labels, each one of the two charts, unless a chart would fall apart, lose too
    /// many faces or change its topology. False if nothing has changed.
    bool take(const std::array<Side, 2>& sides, const NewLabels& labels, const Rule& rule);

private:
    struct Topology {
        Index faces = 0;
        Index doubled_euler = 0;
    };
    Topology topology(Face start);

    const Mesh& mesh_;
    std::vector<Index>& chart_;
    std::vector<Index> valence_;         // #V: faces of an inner vertex, −1 on the boundary
    std::vector<Index> corners_;         // #V: scratch of topology()
    std::vector<std::uint8_t> in_flood_; // #F: scratch of topology()
    std::vector<Index> reached_;         // scratch of topology()
};

} // namespace devseg::growth
