// The surface on which decisions are made, and the way back to the full one.
#pragma once

#include <memory>
#include <vector>

#include "devseg/mesh/coarsen.h"
#include "devseg/refine/darts.h"
#include "devseg/refine/draft.h"

namespace devseg {

/// Of the surface: smaller pieces are slivers that nobody wants to cut out.
constexpr double fragment_share = 0.002;

struct FullCharts {
    std::vector<Index> chart;       // #F, edge-connected
    std::vector<std::uint8_t> seam; // 3 #F: darts
    Index darts = 0;
};

/// A coarse version of a large surface, or the surface itself. Creased surfaces are coarsened less:
/// borders must run exactly along their creases.
class WorkingSurface {
public:
    WorkingSurface(const Mesh& full, bool creased, Index charts, Progress& progress);

    const Mesh& mesh() const { return coarse_ ? coarse_->mesh : full_; }

    /// The draft's charts and darts on the full surface, borders straightened there. `patch` is #F
    /// of mesh(): what the charts were joined from.
    FullCharts carry_over(const Draft& draft, const std::vector<Index>& patch,
                          double max_fitting_error, bool straighten, Progress& progress) const;

    /// Darts on the full surface, to spots that a coarse one does not have; returns their number.
    Index cut_more_darts(const DartOptions& options, const std::vector<Index>& chart,
                         std::vector<std::uint8_t>& seam, Progress& progress) const;

    /// Stretch of the charts' final map on the full surface.
    StretchBounds measure(const std::vector<Index>& chart, const std::vector<std::uint8_t>& seam,
                          Progress& progress) const;

    /// F of each face of the full surface in its chart's best conic.
    std::vector<double> fitting_errors(const std::vector<Index>& chart) const;

private:
    void straighten_twice(const Draft& draft, const std::vector<Index>& patch,
                          double max_fitting_error, std::vector<Index>& chart,
                          Progress& progress) const;
    std::vector<Index> tips_of(const Draft& draft) const;

    const Mesh& full_;
    bool creased_;
    std::unique_ptr<CoarseSurface> surface_;
    std::unique_ptr<CoarseMesh> coarse_;
};

} // namespace devseg
