// The parameters of filters that know a material: declared once for all of them.
#pragma once

#include "devseg/declare/declare.h"
#include "devseg/material/material.h"
#include "devseg/pattern/pieces.h"

namespace devseg::filters {

/// Options derive from pattern::PatternOptions.
template <class O>
declare::Declare<O> with_material(declare::Declare<O> filter) {
    return filter
        .text(&O::material, "material", "Material",
              "What pieces are cut from: " + material::names() +
                  ". Values of its own follow as in fleece, warp=0.12, thickness_mm=2. Empty: "
                  "nothing is said about strain.")
        .real(&O::thickness_mm, "Thickness (mm)",
              "Thickness of the material in millimetres, which lies inside of the model's surface: "
              "pieces get shorter where they bend. 0 = none.")
        .real(&O::bend_radius_mm, "Radius of bends (mm)",
              "Inner radius of sharp bends in millimetres. -1 = the least one of the material, or "
              "the thickness.")
        .real(&O::k_factor, "K factor",
              "Where the length of a bend stays the same: share of the thickness from its inner "
              "side. -1 = that of the material, or 0.5.");
}

/// For filters that show where the threads run.
template <class O>
declare::Declare<O> with_grain(declare::Declare<O> filter) {
    pattern::GrainDirection O::*grain = &O::grain;
    return filter
        .choice(grain, "grain", "Grain",
                {"Best fit", "Longest side", "Up", "Angle", "Texture v", "Free"},
                "Where the threads run in each piece. Best fit: as they strain the material least. "
                "Longest side: along it. Up: upwards on the model. Angle: at an angle to the "
                "texture's v. Texture v: along that. Free: as they fit best, and layouts turn "
                "pieces as they like.")
        .real(&O::grain_angle, "Angle of the grain (degrees)",
              "With the grain at an angle: degrees from the texture's v, counterclockwise.");
}

} // namespace devseg::filters
