// A pattern piece with all that is drawn for it: cut lines with allowance or tabs, sew lines,
// folds, notches, numbers.
#pragma once

#include <string>
#include <vector>

#include "devseg/declare/filter.h"
#include "devseg/pack/pack.h"
#include "devseg/pattern/pattern.h"
#include "sheet/allowance.h"
#include "sheet/export_options.h"
#include "sheet/tabs.h"
#include "writers/drawing.h"

namespace devseg::sheet {

/// A place on the sew line where the two sides of a seam are to meet.
struct SheetNotch {
    Vec2 outer = Vec2::Zero(); // mm; on the cut line where there is one close by
    Vec2 inner = Vec2::Zero(); // towards the inside

    /// From end to end: a slit, or a triangle that is open at the edge.
    std::vector<Vec2> line(NotchKind kind) const;
};

/// From the pattern's pieces to where they are drawn.
struct SheetFrame {
    bool mirrored = false; // at the axis x = 0, first of all
    pack::Placement placement;

    Vec2 operator()(const Vec2& p) const { return placement(mirrored ? Vec2(-p.x(), p.y()) : p); }
    Vec2 direction(const Vec2& v) const { return (*this)(v) - (*this)(Vec2::Zero()); }
};

struct SheetPiece {
    Index piece = -1; // position in Pattern::pieces
    std::string name;
    std::vector<std::vector<Vec2>> cut; // closed; the outer one first
    std::vector<std::vector<Vec2>> sew; // closed; empty where the cut lines are the sew lines
    // #cut and #sew with Bézier curves, which the closed lines follow within micrometres; or empty.
    std::vector<std::vector<pattern::OutlineCurve>> cut_curves;
    std::vector<std::vector<pattern::OutlineCurve>> sew_curves;
    std::vector<std::vector<Vec2>> slits;     // open lines whose two sides lie on each other
    std::vector<std::vector<Vec2>> mountains; // open lines
    std::vector<std::vector<Vec2>> valleys;
    std::vector<std::vector<Vec2>> perforations; // folds as short cuts, instead of their lines
    std::vector<std::vector<Vec2>> shadows;      // where tabs of others are glued
    std::vector<SheetNotch> notches;
    std::vector<std::vector<Vec2>> drills;   // crosses where darts end
    std::vector<std::vector<Vec2>> openings; // brackets along what stays open
    std::vector<std::vector<Vec2>> grain;    // the arrow's lines
    std::vector<writers::DrawingText> names;
    std::vector<writers::DrawingText> numbers; // of seams
    std::vector<std::vector<Vec2>> leaders;    // lines from seams to numbers that lie apart
    std::array<Vec2, 2> grain_line{Vec2::Zero(), Vec2::Zero()};
    Index sheet = 0; // on which it lies
    SheetFrame frame;

    bool has_allowance() const { return !sew.empty(); }
    Eigen::AlignedBox2d box() const;
    /// Moves everything. Texts do not turn: they are added in the piece's place (marks.h).
    void move(const pack::Placement& placement);
    /// Turns everything over at the line x = `axis`, once and after all moves: mountain folds
    /// become valley folds.
    void mirror(double axis);
};

/// A colour for each piece of the pattern, and a last one for faces in no piece.
std::vector<declare::Color> piece_colors(const pattern::Pattern& pattern);

/// The piece as the options want it, where the pattern has it, without texts. `tabs` has a list for
/// each piece, or none.
SheetPiece compose_piece(const pattern::Pattern& pattern, Index piece, const GlueTabs& tabs,
                         const ExportOptions& options);

} // namespace devseg::sheet
