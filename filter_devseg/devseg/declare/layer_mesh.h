// A new mesh that a filter makes beside the host's own.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "devseg/mesh/input_gate.h"

namespace devseg::declare {

using Color = std::array<std::uint8_t, 3>; // red, green, blue

/// A mesh of its own, in model units or millimetres as the filter says.
struct LayerMesh {
    std::string name;
    mesh::RawMesh geometry;
    std::vector<Color> face_color;                                         // #F
    std::vector<double> face_quality;                                      // #F
    std::vector<std::pair<std::string, std::vector<int>>> face_attributes; // by name, #F each
};

} // namespace devseg::declare
