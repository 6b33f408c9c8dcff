// What happens to the material between the paper and the model, face by face.
#pragma once

#include "devseg/pattern/pieces.h"

namespace devseg::pattern {

/// The lines in a face that are longest and shortest on paper, compared with the model.
struct FaceStrain {
    double extension = 0.0;   // 0.05 = 5 % longer on paper; 0 where all lines are shorter
    double compression = 0.0; // 0.05 = 5 % shorter on paper; 0 where all lines are longer

    double largest() const { return extension > compression ? extension : compression; }
};

/// Strain of all faces (#F): `paper` (3 #F) are their corners in the plane, in units of which one
/// is `scale` internal units of the mesh. Faces without area on the model or in the plane have
/// none.
std::vector<FaceStrain> measure_strain(const Mesh& mesh, const std::vector<Vec2>& paper,
                                       double scale);

/// Sets strain and folds of the piece that was made of the given faces, with their corners on
/// `paper` (3 #F) in mm; `mm` is the length of the mesh's internal unit there, `fold_angle` is in
/// radians.
void measure_inside(const Mesh& mesh, const std::vector<Vec2>& paper,
                    const std::vector<Index>& faces, const std::vector<std::uint8_t>& seam,
                    const std::vector<FaceStrain>& strain, double fold_angle, double mm,
                    PatternPiece& piece);

} // namespace devseg::pattern
