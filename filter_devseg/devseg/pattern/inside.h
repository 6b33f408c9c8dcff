// The inside of a piece: where its faces lie on paper, how the material is strained there, folds.
#pragma once

#include <vector>

#include "devseg/atlas/texture.h"
#include "devseg/pattern/pattern.h"
#include "devseg/pattern/pieces.h"

namespace devseg::pattern {

/// The places on paper of all corners of the given faces, in mm: 3 for each. Corners follow the
/// outlines of the piece, which may have been changed to match its seams: a corner on an outline
/// moves with it, one inside by a mean of all moves.
std::vector<Vec2> place_corners(const Mesh& mesh, const CornerUv& uv,
                                const std::vector<Index>& faces, const PatternPiece& piece);

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

/// The angle by which the surface bends at an edge, radians, positive = mountain (seen from the
/// outside); 0 on boundaries.
double fold_angle_at(const Mesh& mesh, HalfEdge h);

/// Sets strain and folds of the piece that was made of the given faces, with their corners on
/// `paper` (3 #F) in mm; `mm` is the length of the mesh's internal unit there, `fold_angle` is in
/// radians.
void measure_inside(const Mesh& mesh, const std::vector<Vec2>& paper,
                    const std::vector<Index>& faces, const std::vector<std::uint8_t>& seam,
                    const std::vector<FaceStrain>& strain, double fold_angle, double mm,
                    PatternPiece& piece);

} // namespace devseg::pattern
