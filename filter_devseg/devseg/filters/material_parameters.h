// The parameters of filters that know a material: declared once for all of them.
#pragma once

#include "devseg/declare/declare.h"
#include "devseg/material/material.h"
#include "devseg/pattern/pieces.h"

namespace devseg::filters {

/// Options derive from pattern::PatternOptions.
template <class O>
declare::Declare<O> with_material(declare::Declare<O> filter) {
    pattern::GrainDirection O::*grain = &O::grain;
    return filter
        .text(&O::material, "material", "Material",
              "What pieces are cut from: " + material::names() +
                  ". Values of its own follow as in fleece, warp=0.12, thickness_mm=2. Empty: "
                  "nothing is said about strain.")
        .choice(grain, "grain", "Grain",
                {"Best fit", "Longest side", "Up", "Angle", "Texture v", "Free"},
                "Where the threads run in each piece: as they strain the material least, along the "
                "longest side, upwards on the model, at an angle to the texture's v, or along "
                "that. Free: as they fit best, and layouts turn pieces as they like.")
        .real(&O::grain_angle, "Angle of the grain (degrees)",
              "With the grain at an angle: degrees from the texture's v, counterclockwise.");
}

} // namespace devseg::filters
