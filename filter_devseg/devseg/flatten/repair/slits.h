// Slits that close in the plane: their two sides must stay apart, or the cut is lost.
#pragma once

#include <vector>

#include "devseg/atlas/charts.h"

namespace devseg::flatten {

/// Least distance of the two sides of a cut, as a share of the root of the model's area: far above
/// what readers of texture coordinates take for rounding (1e-6 of the layout), and far below what a
/// person or a cutter sees (0.015 mm on a sheet of 300 mm).
constexpr double slit_gap = 5e-5;

/// Where the two sides of a cut inside the chart are closer in the plane than `gap` (a length in
/// the plane), as around a hole in a flat sheet, moves both inwards by half of it. Texture
/// coordinates tell a cut only by a difference: without one, readers would see a chart with a hole
/// more than the one that was flattened. A vertex stays where it is if moving it would flip a
/// face.
void open_closed_slits(const Mesh& mesh, const atlas::ChartSurface& surface, double gap,
                       std::vector<Vec2>& uv);

/// Whether a reader that takes points closer than `gap` for one would find other boundary loops
/// than the surface has: where a cut between a hole and the rim closes over its whole length, say.
bool closed_slits_hide_loops(const Mesh& mesh, const atlas::ChartSurface& surface, double gap,
                             const std::vector<Vec2>& uv);

} // namespace devseg::flatten
