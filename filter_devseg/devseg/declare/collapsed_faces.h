// Faces of the host that the gate has drawn to a line or a point: their way in and out.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "devseg/declare/filter.h"

namespace devseg::declare {

/// What is written where a host keeps bits 1, 2, 4.
int edge_bits(double value);

/// Seams of the collapsed faces, once those of all others are there: as their neighbours say, and
/// between two of them where their charts differ. `cut` (3 #F) has the others' by half-edges. Those
/// of faces that stay are what they were, but to faces that do not.
void set_collapsed_seams(const mesh::GatedMesh& gated, const HostMesh& host,
                         const std::vector<std::uint8_t>& cut, HostResult& result);

/// Coordinates of the collapsed faces, where those of their corners are: with an area that is too
/// small for readers of 32 bits to see, but with the right sign.
class CollapsedCorners {
public:
    CollapsedCorners(const mesh::GatedMesh& gated, const CornerUv& uv);
    std::array<Vec2, 3> of(const mesh::CollapsedFace& face) const;

private:
    std::array<Vec2, 3> widened(std::array<Vec2, 3> corners, bool is_flipped) const;

    const mesh::GatedMesh& gated_;
    const CornerUv& uv_;
    Vec2 middle_;
    double step_; // of 32-bit numbers as large as the largest coordinate
};

} // namespace devseg::declare
