// Pattern pieces: the outlines of flattened charts on paper, in millimetres and at true scale.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "devseg/mesh/texture.h"
#include "devseg/progress.h"

namespace devseg {

struct PatternOptions {
    double mm_per_unit = 1.0; // millimetres on paper for one unit of the model, above 0
    double height_mm = 0.0;   // size of the finished model along y (MeshLab's up axis), in mm;
                              // replaces mm_per_unit where it is above 0
    bool labels = true;       // write each piece's name into it
};

/// A closed outline: the last point is joined to the first one, which is not repeated.
struct PiecePath {
    std::vector<Vec2> points; // mm, y up
    double area = 0.0;        // mm², positive where the points run counterclockwise
};

struct PatternPiece {
    std::string name;                   // "P01", "P02", … in the order of the charts
    Index chart = -1;                   // label in charts_from_uv
    PiecePath outer;                    // counterclockwise; darts and slits are part of it
    std::vector<PiecePath> holes;       // clockwise
    double area = 0.0;                  // mm², without the holes
    double length_scale = 1.0;          // paper length / true length, from the areas; 1 = true
    Vec2 label_position = Vec2::Zero(); // the point inside that is farthest from all outlines
    double label_radius = 0.0;          // mm, its distance from them
    Eigen::AlignedBox2d box;            // mm
};

/// The pieces as they lie on the sheet: within [0, width] × [0, height], seen from outside the
/// model, y up.
struct Pattern {
    std::vector<PatternPiece> pieces;
    double width = 0.0;             // mm
    double height = 0.0;            // mm
    double mm_per_unit = 1.0;       // as used, from height_mm where that was given
    std::vector<std::string> notes; // what the user should know, one sentence each
};

/// Texture coordinates (3 #F, made by anyone) → pieces. Charts, darts and slits are read off the
/// coordinates, and so is the layout; all charts get one common scale, at which the areas on paper
/// and on the model are equal. Charts that are mirrored as a whole, as atlases for painting often
/// have them, are turned over, so that every piece shows the outside of the model.
///
/// Throws InvalidParameter for a scale outside its range, InvalidMesh where the coordinates are
/// missing, not finite or without area, Cancelled.
Pattern make_pattern(const Mesh& mesh, const CornerUv& uv, const PatternOptions& options,
                     Progress& progress);

} // namespace devseg
