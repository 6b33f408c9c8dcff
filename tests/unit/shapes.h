// Meshes built in code: the inputs of the unit tests.
//
// Orientation: open shapes of the plane face +z, all others face outward.
#pragma once

#include <string>
#include <vector>

#include "devseg/mesh/input_gate.h"

namespace devseg::shapes {

constexpr double pi = 3.14159265358979323846;

/// width × height in the plane z = 0, cut into columns × rows squares of two triangles.
mesh::RawMesh grid(Index columns, Index rows, double width = 1.0, double height = 1.0);

/// Rows of '#' (cell) and '.' (hole), unit cells; the first row is the lowest. A cell of a plate
/// is a square; a cell of a slab is a cube, so that a slab is closed and its holes are handles.
using Mask = std::vector<std::string>;
mesh::RawMesh plate(const Mask& mask);
mesh::RawMesh slab(const Mask& mask);
/// A row of `holes` holes with a frame of one cell around them.
Mask mask_with_holes(Index holes);

/// The profile (radius, height) turned around the z axis. A radius of 0 is an apex and may be at
/// the ends only. A closed profile joins its end to its start.
mesh::RawMesh revolve(const std::vector<Vec2>& profile, Index around, bool closed = false);

mesh::RawMesh cylinder_tube(Index around, Index along, double radius = 1.0, double height = 2.0);
mesh::RawMesh capped_cylinder(Index around, Index along, double radius = 1.0, double height = 2.0);
mesh::RawMesh cone(Index around, Index along, double radius = 1.0, double height = 2.0); // no base
mesh::RawMesh frustum(Index around, Index along, double radius, double top, double height);
mesh::RawMesh annulus(Index around, Index rings, double inner, double outer);
mesh::RawMesh hemisphere(Index around, Index rings);
/// A tube, closed at one end by an apex.
mesh::RawMesh finger(Index around, Index along, double radius, double length);
mesh::RawMesh torus(Index around, Index tube, double large = 2.0, double small = 1.0);
mesh::RawMesh double_torus();             // a slab with two holes
mesh::RawMesh sphere(Index subdivisions); // icosphere of radius 1
mesh::RawMesh cube(Index cells);          // of side 1, each face cells × cells squares
mesh::RawMesh tetrahedron();
mesh::RawMesh moebius_strip(Index around, Index across = 1);
/// A plate with two holes, and a bent tube on it that joins two more: three loops and a handle.
mesh::RawMesh plate_with_handle();

/// A strip that winds around the z axis like a spiral staircase: laid flat, it runs over itself
/// where it makes more than one turn.
mesh::RawMesh helix_strip(Index steps, double turns, double inner, double outer, double rise);

/// A ring of more than a turn, which rises slowly: laid flat, it lies on itself. 20,000 faces, with
/// waves of that height.
mesh::RawMesh ramp(double turns = 1.3, double waves = 0.0);

/// Rays from the origin in a zigzag, each at the same angle (radians) from the last: a folded ring
/// sector of so many sectors, which may be more than a full turn in the plane. Points run along
/// rows of sectors + 1.
mesh::RawMesh zigzag_fan(Index sectors, double angle, double inner, double outer, Index rows);

/// A strip of paper, folded by the same angle (radians) along rulings whose direction varies: a
/// tangent developable, built from its development.
mesh::RawMesh folded_strip(Index folds, Index rows, double angle);

} // namespace devseg::shapes
