// A drawing on one sheet, in millimetres, that every file format can hold: layers with paths and
// texts. No Qt, no MeshLab.
//
// The origin is the lower left corner of the sheet and y points up, as in PDF, DXF and the plane
// of the texture coordinates; writers of formats with y down turn it over.
#pragma once

#include <string>
#include <vector>

#include "devseg/mesh/mesh.h"

namespace devseg {

struct DrawingPolyline {
    std::vector<Vec2> points; // a closed one does not repeat its first point
    bool closed = true;
};

/// One object for the reader of the file: an outline and its holes, or a single line.
struct DrawingPath {
    std::string id; // unique in the drawing, or empty
    std::vector<DrawingPolyline> parts;
};

struct DrawingText {
    Vec2 centre = Vec2::Zero(); // of the capital letters
    double size = 0.0;          // font size (em), mm
    std::string text;           // UTF-8
};

struct DrawingLayer {
    std::string id;           // unique in the drawing
    std::string label;        // for people
    std::string colour;       // "#rrggbb"
    std::vector<double> dash; // lengths of strokes and gaps in mm; empty = solid
    std::vector<DrawingPath> paths;
    std::vector<DrawingText> texts;
};

struct Drawing {
    double width = 0.0;               // mm
    double height = 0.0;              // mm
    int decimals = 3;                 // of all numbers in the file, enough for the smallest path
    std::vector<DrawingLayer> layers; // those without paths and texts are not written
};

} // namespace devseg
