// The lines of a DXF file of release 12: a group code and its value, again and again.
#pragma once

#include <string>

#include "writers/drawing.h"

namespace devseg {

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

    void polyline(const std::string& layer, const DrawingPolyline& line);
    void line(const std::string& layer, const Vec2& from, const Vec2& to);
    void text(const std::string& layer, const DrawingText& text);

    /// The whole file, ended.
    std::string file() const { return bytes_ + "  0\r\nEOF\r\n"; }

private:
    int decimals_;
    std::string bytes_;
};

} // namespace devseg
