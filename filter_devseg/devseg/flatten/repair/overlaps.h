// Parts of one chart that overlap in the plane: found, pushed apart, cut apart.
//
// References
//   [LPRM02] B. Lévy, S. Petitjean, N. Ray, J. Maillot: Least Squares Conformal Maps for Automatic
//            Texture Atlas Generation. ACM Transactions on Graphics 21(3), 2002, section 3.2.
#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "devseg/atlas/charts.h"
#include "devseg/base/progress.h"
#include "devseg/flatten/energy/contacts.h"
#include "devseg/flatten/energy/rest_shape.h"

namespace devseg::flatten {

/// Faces that overlap, two by two.
using Pairs = std::vector<std::pair<Index, Index>>;

/// Whether a map without flips is one-to-one, read off its boundary: it does not cross itself, by
/// exact orientation tests of edges against edges, and only one of its loops runs counterclockwise.
/// The boundary of n loops turns by 2π (2 − n), and by 2π more for each corner of more than a full
/// turn, which also two sides of a hole can have that is turned inside out and crosses nothing.
/// Without such corners, one of the loops runs around the others, which lie beside each other.
bool is_one_to_one(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv);

/// Pairs of faces that overlap by more than `tolerance` (a length in the plane); empty when the
/// map is one-to-one.
Pairs overlapping_pairs(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv,
                        double tolerance);

/// Whether there are any: stops at the first.
bool overlaps_itself(const atlas::ChartSurface& surface, const std::vector<Vec2>& uv,
                     double tolerance);

/// Half-edges of the surface that cut it in two along a short path, such that the two faces of the
/// first overlapping pair, with as many of the faces around them that take part in the overlap as
/// possible, come apart. Half-edges are local, one for each edge. `at_folds`: sharp folds count
/// less, as cuts of paper are not seen there.
std::vector<Index> separating_path(const Mesh& mesh, const atlas::ChartSurface& surface,
                                   const Pairs& pairs, const Progress& progress = Progress(),
                                   bool at_folds = false);

/// Moves a map (#v) while contacts push on it; empty where that fails.
using PushContacts =
    std::function<std::vector<Vec2>(const std::vector<Vec2>& uv, const ContactPenalty& contacts)>;

/// The map with its overlapping parts pushed apart by a penalty on contacts; `pairs` are the faces
/// that overlap. Nothing if that does not help, or costs too much shape: then a cut
/// keeps the pattern truer. `gap_share` is the distance to leave, of the chart's size.
std::optional<std::vector<Vec2>> push_apart_by(const PushContacts& push,
                                               const FlatteningProblem& problem,
                                               const atlas::ChartSurface& surface,
                                               std::vector<Vec2> uv, Pairs pairs, double tolerance,
                                               double gap_share = 3e-4);

/// The same towards the least symmetric Dirichlet energy.
std::optional<std::vector<Vec2>> push_apart(const FlatteningProblem& problem,
                                            const atlas::ChartSurface& surface,
                                            std::vector<Vec2> uv, Pairs pairs, double tolerance,
                                            const Progress& progress, double gap_share = 3e-4);

} // namespace devseg::flatten
