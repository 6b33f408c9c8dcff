// A pattern: the pieces of a model on paper with their seams, in millimetres and at true scale.
// Plain data that writers and filters read; make_pattern (pieces.h) builds it.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "devseg/material/material.h"
#include "devseg/mesh/mesh.h"
#include "devseg/pattern/seam.h"

namespace devseg::pattern {

constexpr double no_extent = 1e-9;  // share of a size below which lengths are rounding
constexpr double vanishing = 1e-12; // the same for areas
constexpr double gap_share = 0.02;  // between pieces that are laid out anew, of the layout's size

/// One cubic Bézier curve of an outline; straight lines are curves as well (`is_line`).
struct OutlineCurve {
    std::array<Vec2, 4> control{Vec2::Zero(), Vec2::Zero(), Vec2::Zero(), Vec2::Zero()}; // mm
    bool is_line = true;
    Index first = 0; // the curve stands for the edges first … first + count − 1 of the outline
    Index count = 1;
};

/// A closed outline: the last point is joined to the first one, which is not repeated. Edge i runs
/// from point i to point i + 1; the piece lies on its left.
struct PiecePath {
    std::vector<Vec2> points;         // mm, y up
    double area = 0.0;                // mm², positive where the points run counterclockwise
    std::vector<std::uint8_t> corner; // #points: 1 at corners; the outline is smooth elsewhere
    std::vector<OutlineSeam> edges;   // #points: what lies along edge i
    std::vector<Index> half_edge;     // #points: of the mesh: it starts at point i, and edge i
                                      // stands for it and those that follow it in the outline
    std::vector<OutlineCurve> curves; // the whole outline in order, within the curve tolerance
};

/// From the texture coordinates to the sheet, for one piece: `scale` is negative where the chart
/// was turned over. Outlines follow it up to their simplification, unless they were changed to
/// match seams: Pattern::corner_place has the faces as they lie inside the outlines.
struct PaperMap {
    Vec2 origin = Vec2::Zero(); // in the texture coordinates
    Vec2 scale = Vec2::Ones();  // mm for one unit, along x and y
    Vec2 offset = Vec2::Zero(); // mm

    Vec2 operator()(const Vec2& p) const { return scale.cwiseProduct(p - origin) + offset; }
};

/// An edge inside a piece along which the surface bends, for creasing.
struct PieceFold {
    Vec2 from = Vec2::Zero(); // mm
    Vec2 to = Vec2::Zero();
    double angle = 0.0; // radians between the normals, positive = mountain (seen from the outside)
};

/// How much the material is strained between the paper and the model. Extension and compression
/// are those of a line in the material at the worst place: 0.05 = 5 % longer or shorter on paper.
struct PieceStrain {
    double extension = 0.0;
    double compression = 0.0;
    double mean = 0.0;               // mean of the larger of the two over the area
    double area_change = 0.0;        // area on paper / area on the model − 1
    Vec2 worst_place = Vec2::Zero(); // mm
    Index worst_face = -1;           // face of the mesh
};

/// The same for a material that has limits: lines of it are longer or shorter on the model.
struct ClothStrain {
    double along = 0.0; // largest of any face along the grain, longer or shorter: 0.05 = 5 %
    double across = 0.0;
    double along_95 = 0.0; // what 95 % of the area keeps
    double across_95 = 0.0;
    // Strain over what the material bears in that direction, in the direction where this is most:
    // what 99 % of the area keeps, and the worst face. Within the limits are 1 and 2.
    double use_99 = 0.0;
    double worst_use = 0.0;
    bool is_within = true;
    Index worst_face = -1;
    Vec2 worst_place = Vec2::Zero(); // mm
};

struct PatternPiece {
    std::string name;                   // "P01", "P02", … in the order of the charts
    Index chart = -1;                   // label in charts_from_uv, or after splitting
    PiecePath outer;                    // counterclockwise; darts and slits are part of it
    std::vector<PiecePath> holes;       // clockwise
    double area = 0.0;                  // mm², without the holes
    Vec2 label_position = Vec2::Zero(); // the point inside that is farthest from all outlines
    double label_radius = 0.0;          // mm, its distance from them
    Eigen::AlignedBox2d box;            // mm

    PaperMap place; // where the chart's texture coordinates come to lie

    // Pieces of one shape are cut together. The first of them is the model of the others.
    Index model = -1;            // position of that piece, the piece's own for the first
    bool mirrored = false;       // it is the mirror image of its model
    Index quantity = 1;          // on the model: pieces of its shape, as it is; 0 on the others
    Index mirrored_quantity = 0; // on the model: pieces that are its mirror image
    std::array<Vec2, 2> grain{Vec2::Zero(), Vec2::Zero()}; // from, to; mm, inside the piece
    Vec2 grain_direction = Vec2::UnitY();                  // unit, also where no line fits
    double long_side = 0.0; // mm, of the smallest box in any direction around the piece
    double short_side = 0.0;
    PieceStrain strain;
    ClothStrain cloth;            // where the pattern has a material
    Index fabric = 0;             // what it is cut from: position in Pattern::fabrics
    std::vector<PieceFold> folds; // every edge that bends by more than fold_angle

    /// Outline 0 is the outer one, outline i is hole i − 1.
    const PiecePath& path(Index i) const {
        return i == 0 ? outer : holes[static_cast<std::size_t>(i - 1)];
    }
    PiecePath& path(Index i) { return i == 0 ? outer : holes[static_cast<std::size_t>(i - 1)]; }
    /// The seams along its outlines, ascending.
    std::vector<Index> seams() const;
    Index path_count() const { return 1 + static_cast<Index>(holes.size()); }
    /// The points of all outlines, the outer one first.
    std::vector<std::vector<Vec2>> rings() const {
        std::vector<std::vector<Vec2>> result;
        for (Index i = 0; i < path_count(); ++i)
            result.push_back(path(i).points);
        return result;
    }
};

/// The pieces as they lie on the sheet: within [0, width] × [0, height], seen from outside the
/// model, y up.
struct Pattern {
    std::vector<PatternPiece> pieces;
    std::vector<Seam> seams; // each joins exactly two sides; every side is in one seam
    double width = 0.0;      // mm
    double height = 0.0;     // mm
    std::optional<material::Material> material;
    std::vector<std::string> fabrics; // names of the model's materials; empty where it is of one
    double mm_per_unit = 1.0;         // as used, from height_mm where that was given
    double hem_length = 0.0;          // mm, of all edges of pieces that are sewn to nothing
    Mesh mesh;                        // with the faces cut that cuts of pieces go through; #F faces
    std::vector<Index> source_face;   // #F: face of the mesh that the pattern was made of
    std::vector<std::uint8_t> seam;   // 3 #F: 1 on edges along which paper or cloth is cut
    std::vector<Index> face_piece;    // #F: piece that each face lies in, −1 = none
    std::vector<Vec2> corner_place;   // 3 #F: where the corners of each face lie on the sheet, mm;
                                      // 0 for faces in no piece
    std::vector<std::string> notes;   // what the user should know, one sentence each
};

} // namespace devseg::pattern
