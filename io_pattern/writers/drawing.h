// A drawing in millimetres that every file format can hold: layers with paths and texts, on one or
// several sheets. No Qt, no MeshLab.
//
// The origin is the lower left corner of the drawing and y points up, as in PDF, DXF and the plane
// of the texture coordinates; writers of formats with y down turn it over.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg::writers {

constexpr double line_width = 0.2; // mm, on paper: still seen where a hairline is not

/// A cubic Bézier curve, or a straight line that is written as one.
struct DrawingCurve {
    std::array<Vec2, 4> control{Vec2::Zero(), Vec2::Zero(), Vec2::Zero(), Vec2::Zero()};
    bool is_line = true;
};

struct DrawingPolyline {
    std::vector<Vec2> points; // a closed one does not repeat its first point
    bool closed = true;
    std::vector<DrawingCurve> curves = {}; // from end to end, instead of the points, or none
};

/// One object for the reader of the file: an outline and its holes, or a single line.
struct DrawingPath {
    std::string id; // unique in the drawing, or empty
    std::vector<DrawingPolyline> parts;
    std::string owner = {}; // the piece that it belongs to, or empty
};

enum class TextAnchor { middle, left };

struct DrawingText {
    Vec2 position = Vec2::Zero(); // of the anchor, at half the height of the capital letters
    double size = 0.0;            // font size (em), mm
    std::string text;             // UTF-8
    double angle = 0.0;           // counterclockwise, radians
    TextAnchor anchor = TextAnchor::middle;
    std::string owner = {}; // the piece that it belongs to, or empty
};

struct DrawingLayer {
    std::string id;           // unique in the drawing
    std::string label;        // for people
    std::string colour;       // "#rrggbb"
    std::vector<double> dash; // lengths of strokes and gaps in mm; empty = solid
    std::vector<DrawingPath> paths;
    std::vector<DrawingText> texts;
};

/// Pixels from the upper left corner, row by row, red, green and blue each.
struct DrawingImage {
    Vec2 low = Vec2::Zero(); // lower left corner, mm
    Vec2 size = Vec2::Zero();
    int columns = 0;
    int rows = 0;
    std::vector<std::uint8_t> rgb; // 3 columns rows
    // In drawings: shown inside of these rings alone, by the even-odd rule.
    std::vector<DrawingPolyline> clip = {};
    std::string owner = {}; // the piece that it belongs to, or empty
};

/// A rectangle of the drawing that is one piece of paper, fabric or board.
struct DrawingSheet {
    Vec2 low = Vec2::Zero();
    Vec2 size = Vec2::Zero();
};

constexpr const char* image_layer = "texture"; // id
constexpr const char* image_label = "Texture"; // for people

struct Drawing {
    double width = 0.0;               // mm
    double height = 0.0;              // mm
    int decimals = 3;                 // of all numbers in the file, enough for the smallest path
    std::vector<DrawingLayer> layers; // those without paths and texts are not written
    std::vector<DrawingImage> images; // below all layers, a layer of their own ("texture")
    std::vector<DrawingSheet> sheets; // none: the whole drawing is one
    std::vector<DrawingSheet> pages;  // of the sheets; those of one sheet share strips
    /// 0 where the whole drawing is one sheet.
    Vec2 sheet_low(Index sheet) const {
        return sheets.empty() ? Vec2(Vec2::Zero()) : sheets[at(sheet)].low;
    }
    bool by_piece = false; // what belongs to one piece makes one group, if a format
                           // knows groups
};

/// A rectangle of a drawing, shown on a page at a scale and cut off at its borders.
struct PageWindow {
    Vec2 low = Vec2::Zero(); // of the rectangle, in the drawing
    Vec2 size = Vec2::Zero();
    Vec2 position = Vec2::Zero(); // of its lower left corner on the page
    double scale = 1.0;           // paper / drawing
};

struct DocumentPage {
    double width = 0.0;  // mm
    double height = 0.0; // mm
    std::vector<PageWindow> windows;
    std::vector<DrawingLayer> marks; // on top, in page coordinates; the same ids on every page
    std::vector<DrawingImage> images;
};

/// A drawing with the pages it is printed on.
struct Document {
    std::string title; // UTF-8
    Drawing drawing;
    std::vector<DocumentPage> pages;
};

} // namespace devseg::writers
