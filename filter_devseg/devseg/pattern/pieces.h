// Texture coordinates → pattern: the outlines of flattened charts as pieces on paper.
#pragma once

#include "devseg/atlas/texture.h"
#include "devseg/base/option_checks.h"
#include "devseg/base/progress.h"
#include "devseg/pattern/pattern.h"

namespace devseg::pattern {

/// Where the threads of a woven cloth run in a piece: as it fits the material best, along the
/// longest direction (also where nothing says what fits), upwards on the model, at an angle to the
/// texture's v, or along that. Free: as it fits best, and layouts turn pieces as they like.
enum class GrainDirection { best, longest, up, angle, texture_v, free };

struct PatternOptions {
    double mm_per_unit = 1.0; // millimetres on paper for one unit of the model, above 0
    double height_mm = 0.0;   // size of the finished model along y (MeshLab's up axis), in mm;
                              // replaces mm_per_unit where it is above 0
    bool labels = true;       // write each piece's name into it

    // A vertex of an outline is left out where that moves neither side of the seam by more; pieces
    // smaller than 100 mm have less, in proportion to their size. 0 keeps all vertices.
    double simplify_mm = 0.1;
    double corner_angle = 40.0;     // degrees: an outline that turns by more has a corner
    double curve_mm = 0.0;          // largest distance of curves from the outline; 0: none
    bool match_seams = true;        // make both sides of each seam equally long
    double notch_spacing_mm = 50.0; // mean distance of the notches of a seam; 0 = none
    double fold_angle = 3.0;        // degrees: flatter edges are no folds
    double max_piece_mm = 0.0;      // longest side of a piece; larger ones are cut; 0 = no limit
    double max_width_mm = 0.0;      // the same of the shorter side of the least box around it
    double alike_mm = 0.0;          // pieces whose outlines differ by less become alike; 0: none
    double pair_tolerance_mm = 0.5; // pieces whose outlines differ by less have the same shape
    GrainDirection grain = GrainDirection::best;
    double grain_angle = 0.0;     // degrees from the texture's v, counterclockwise
    double thickness_mm = 0.0;    // of the material, inside of the mesh
    double bend_radius_mm = -1.0; // of sharp bends; below 0: as the material says, or the thickness
    double k_factor = -1.0;       // neutral line; below 0: as the material says, or 0.5
    std::string material;         // material::read_material; empty: none

    static OptionRanges<PatternOptions> ranges();
};

/// Texture coordinates (3 #F, made by anyone) → pieces. Charts, darts and slits are read off the
/// coordinates, and so is the layout; all charts get one common scale, at which the areas on paper
/// and on the model are equal, or each that of its own (atlas::even_layout). Charts that are
/// mirrored as a whole, as atlases for painting often have them, are turned over, so that every
/// piece shows the outside of the model.
///
/// Throws InvalidParameter for a scale outside its range, InvalidMesh where the coordinates are
/// missing, not finite or without area, Cancelled.
Pattern make_pattern(const Mesh& whole, const CornerUv& uv, const PatternOptions& options,
                     Progress& progress);

} // namespace devseg::pattern
