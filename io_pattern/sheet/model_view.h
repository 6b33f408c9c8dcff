// A picture of the model with its pieces, without graphics hardware.
#pragma once

#include <vector>

#include "devseg/mesh/mesh.h"
#include "devseg/pattern/pattern.h"
#include "writers/drawing.h"

namespace devseg::sheet {

struct PieceLabel {
    Index piece = -1;
    Vec2 position = Vec2::Zero(); // in the unit square of the picture, y up
    double radius = 0.0;          // distance from the piece's border in the picture, same units
};

struct ModelView {
    writers::DrawingImage image;    // square; place and size are the caller's
    std::vector<PieceLabel> labels; // where the pieces that can be seen are best seen
};

/// Parallel projection from `azimuth` (radians about y, 0 = from the front, along −z) and a little
/// above; a colour for each piece, dark lines along the seams.
ModelView draw_model(const Mesh& mesh, const pattern::Pattern& pattern, double azimuth, int pixels);

} // namespace devseg::sheet
