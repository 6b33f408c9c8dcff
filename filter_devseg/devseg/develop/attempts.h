// What a deformation learns from attempts that went wrong: which vertices to cut open and which
// points to hold back.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "devseg/develop/deform.h"

namespace devseg::develop {

/// What an attempt begins with.
struct Attempt {
    std::vector<double> ease;         // by point, 0 to 1: how easily it moves
    std::vector<std::uint8_t> opened; // #V: 1 where a slit is to lead to
    int number = 0;
    int faulty = 0; // of them: with faults at places
};

/// Pairs of faces that cross after a deformation and did not before.
using Crossings = std::vector<std::pair<Index, Index>>;

/// Changes `attempt` for the next time, by what is wrong with the result of this one: defects above
/// the tolerance, crossings, vertices that moved too far. Where slits may be cut (`adjust_slits`),
/// vertices there are opened, farther around and with smaller defects each time, and in the end the
/// charts that are concerned are opened at all vertices with defects and do not move at all: they
/// are developable then. So this ends. Where all moved too far in the mean, every chart that did
/// gets a slit to the vertex that moved farthest: how much a surface has to give up does not show
/// in the angles of its vertices, which are as small as its faces are. Returns false where nothing
/// is wrong, or nothing can be done.
bool learn(const Mesh& mesh, const std::vector<Index>& point_of, const DeformOptions& options,
           const DeformResult& result, const Crossings& crossings, Attempt& attempt);

/// The diagonal of the box around all points, internal units.
double diagonal_of(const std::vector<Vec3>& points);

} // namespace devseg::develop
