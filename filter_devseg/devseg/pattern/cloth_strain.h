// How the material of a piece is strained along its grain, across it and on the bias, beside what
// it bears; and the grain direction that fits best.
//
// The map of a face goes from the paper to the model. A line of the material whose length there is
// λ times that on paper is strained by λ − 1.
#pragma once

#include <vector>

#include "devseg/material/material.h"
#include "devseg/mesh/mesh.h"
#include "devseg/pattern/pattern.h"
#include "devseg/pattern/pieces.h"

namespace devseg::pattern {

/// Squared lengths on the model of lines on paper: that of the direction (c, s) is
/// xx c² + 2 xy c s + yy s².
struct FaceMetric {
    double xx = 1.0;
    double xy = 0.0;
    double yy = 1.0;
    double weight = 0.0;    // area of the face on the model, any unit
    Index face = -1;        // of the mesh
    Vec2 up = Vec2::Zero(); // on paper, the direction of the model's y axis as it lies in the face
};

/// Of the given faces, with their corners on `paper` (3 #F) in mm; `mm` is the length of the mesh's
/// internal unit there. Faces without area have none.
std::vector<FaceMetric> face_metrics(const Mesh& mesh, const std::vector<Vec2>& paper,
                                     const std::vector<Index>& faces, double mm);

/// Strain beside the limits, with the grain along `grain` (unit vector). The places are not set.
ClothStrain measure_cloth(const std::vector<FaceMetric>& faces, const Vec2& grain,
                          const material::Material& material);

/// Of each face (#F) of a pattern with a material: the largest share of its limits that any line
/// in the face needs; negative where that line is shorter on the model. 0 for faces in no piece and
/// without area. `mm` as above.
std::vector<double> limit_uses(const Pattern& pattern, double mm);

/// The unit vector of the grain as the options want it; `longest` is that of the piece's box. Best
/// is what needs the least share of the material's limits, in steps of 5 degrees; the longest
/// direction where all are equal. Upwards is that of the model, on the average of the faces; the
/// longest direction where they have none.
Vec2 choose_grain(const std::vector<FaceMetric>& faces, const PatternOptions& options,
                  const material::Material* material, const Vec2& longest);

/// Sets the piece's sizes, its grain line and, where the pattern has a material, its strain.
/// `faces` are those of the piece, with their corners in pattern.corner_place.
void set_cloth(const Mesh& mesh, const std::vector<Index>& faces, const PatternOptions& options,
               double mm, const Pattern& pattern, PatternPiece& piece);

/// Which pieces exceed the limits, for the user; empty where none does.
std::string cloth_note(const Pattern& pattern);

} // namespace devseg::pattern
