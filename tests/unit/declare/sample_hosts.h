// Meshes of hosts with what filters read: charts, coordinates, colours, selections.
#pragma once

#include "devseg/declare/filter.h"

namespace devseg::declare::hosts {

/// A barrel in four charts and two colours, with a patch of faces selected across a seam, a line of
/// edges that ends inside a chart, and a vertex.
HostMesh chosen_by_hand(double bulge);

/// A ball in two charts, with a face selected in each, and texture coordinates in which the halves
/// above and below lie on each other.
HostMesh halves_of_a_ball();

/// A mesh with everything that filters read: a noisy torus, cut open and flattened. One chart, so
/// that it is packed at once.
HostMesh prepared();

/// The same with a texture and the coordinates that fit it.
HostMesh textured();

/// Twenty cubes, for creases, and a finger, for a tip: one chart each.
HostMesh cubes_and_a_finger();

/// A long bumpy body with a skeleton.
HostMesh bumpy_body();

/// A steep cone and a wedge of it: smooth seams leave the apex, which is inside of a chart then.
HostMesh wedge_of_a_cone();

/// A tube that somebody has laid out as a ring: one chart with two loops.
HostMesh tube_laid_out();

} // namespace devseg::declare::hosts
