// Charts of the full surface: taken over from the decimated one on which they are decided, measured
// as they will be flattened, and mended where a coarse surface could not know better.
#pragma once

#include <optional>
#include <vector>

#include "devseg/mesh/coarsen.h"
#include "devseg/methods/dcharts/developable_charts.h"
#include "devseg/methods/dcharts/draft.h"

namespace devseg::dcharts {

/// The surface on which decisions for about so many charts are made; none where it is small enough
/// itself. Creased surfaces are decimated less: borders must run exactly along their creases.
std::optional<mesh::CoarseMesh> decimate(const Mesh& mesh, bool creased, Index charts,
                                         Progress& progress);

/// What is done to borders on the full surface: nothing; the shortest ones among the faces that fit
/// both charts; and then, in a narrow strip, whatever the faces fit, so that steps go.
enum class Straightening { none, fitting, smooth };

/// The draft's charts and darts on the full surface. `patch` (faces of the draft's surface) is what
/// the charts were joined from.
DevelopableCharts transfer(const Mesh& mesh, const std::optional<mesh::CoarseMesh>& decimation,
                           const Draft& draft, const std::vector<Index>& patch,
                           double max_fitting_error, Straightening straightening,
                           Progress& progress);

} // namespace devseg::dcharts
