// The lines of a DXF file: a group code and its value, again and again.
#pragma once

#include <string>

#include "writers/drawing.h"

namespace devseg::writers {

/// The number of the one of the seven colours that all programs show alike that is nearest to
/// "#rrggbb".
int dxf_colour(const std::string& code);

/// The layer's label as release 12 takes it: capital letters, digits and underscores.
std::string dxf_layer_name(const DrawingLayer& layer);

class DxfText {
public:
    explicit DxfText(int decimals) : decimals_(decimals) {}

    void group(int code, const std::string& value);
    void number(int code, double value);
    void count(int code, int value) { group(code, std::to_string(value)); }
    /// At the group codes 10 and 20, or at 10 + n and 20 + n.
    void point(const Vec2& p, int n = 0);

    void begin_section(const std::string& name);
    void end_section() { group(0, "ENDSEC"); }

    // Entities of release 12.
    void polyline(const std::string& layer, const DrawingPolyline& line);
    void line(const std::string& layer, const Vec2& from, const Vec2& to);
    void text(const std::string& layer, const DrawingText& text);

    /// The groups of a text behind its layer, up to the point that centres it.
    void text_content(const DrawingText& text);

    void append(const std::string& groups) { bytes_ += groups; }
    const std::string& text_so_far() const { return bytes_; }
    DxfText empty_copy() const { return DxfText(decimals_); }

    /// The whole file, ended.
    std::string file() const { return bytes_ + "  0\r\nEOF\r\n"; }

private:
    int decimals_;
    std::string bytes_;
};

} // namespace devseg::writers
