// The surface on which decisions are made, and the way back to the full one.
#pragma once

#include <optional>
#include <vector>

#include "devseg/mesh/coarsen.h"
#include "devseg/methods/dcharts/dcharts.h"
#include "devseg/methods/dcharts/draft.h"

namespace devseg::dcharts {

/// Of the surface: smaller pieces are slivers that nobody wants to cut out.
constexpr double fragment_share = 0.002;

/// What is done to borders on the full surface: nothing; the shortest ones among the faces that fit
/// both charts; and then, in a narrow strip, whatever the faces fit, so that steps go.
enum class Straightening { none, fitting, smooth };

struct FullCharts {
    std::vector<Index> chart;       // #F, edge-connected
    std::vector<std::uint8_t> seam; // 3 #F: darts
    Index darts = 0;
};

struct FinalStretch {
    StretchBounds all;        // over all charts
    std::vector<double> linf; // of each chart
};

/// A coarse version of a large surface, or the surface itself. Creased surfaces are coarsened less:
/// borders must run exactly along their creases.
class WorkingSurface {
public:
    WorkingSurface(const Mesh& full, bool creased, Index charts, Progress& progress);

    const Mesh& mesh() const { return coarse_ ? coarse_->mesh : full_; }

    /// The draft's charts and darts on the full surface. `patch` is #F of mesh(): what the charts
    /// were joined from. Creased surfaces' borders stay on the creases.
    FullCharts carry_over(const Draft& draft, const std::vector<Index>& patch,
                          double max_fitting_error, Straightening straightening,
                          Progress& progress) const;

    /// Darts on the full surface, to spots that a coarse one does not have; returns their number.
    Index cut_more_darts(const DartOptions& options, const std::vector<Index>& chart,
                         std::vector<std::uint8_t>& seam, Progress& progress) const;

    /// Stretch of the charts' final map on the full surface.
    FinalStretch measure(const std::vector<Index>& chart, const std::vector<std::uint8_t>& seam,
                         Progress& progress) const;

    /// Splits charts of the full surface until no spot of the final map is stretched more than
    /// `linf`, or no chart can be split any more. Returns the stretch then.
    FinalStretch split_above(double linf, const DChartsOptions& options, std::vector<Index>& chart,
                             std::vector<std::uint8_t>& seam, Progress& progress) const;

    /// F of each face of the full surface in its chart's best conic.
    std::vector<double> fitting_errors(const std::vector<Index>& chart) const;

private:
    void straighten(const Draft& draft, const std::vector<Index>& patch, double max_fitting_error,
                    Straightening straightening, std::vector<Index>& chart,
                    Progress& progress) const;
    std::vector<Index> tips_of(const Draft& draft) const;

    const Mesh& full_;
    bool creased_;
    std::optional<mesh::CoarseMesh> coarse_;
};

} // namespace devseg::dcharts
