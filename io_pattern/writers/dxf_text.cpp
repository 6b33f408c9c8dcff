// References
//   Autodesk: AutoCAD release 12 customization manual, drawing interchange files. 1992.
#include "writers/dxf_text.h"

#include "writers/number_text.h"
#include "writers/text_metrics.h"

namespace devseg {

namespace {

// Text heights are those of capital letters, not of the font.
constexpr double capital_height = 0.72;

} // namespace

void DxfText::group(int code, const std::string& value) {
    std::string digits = std::to_string(code);
    digits.insert(0, digits.size() < 3 ? 3 - digits.size() : 0, ' ');
    bytes_ += digits + "\r\n" + value + "\r\n";
}

void DxfText::number(int code, double value) {
    const std::string digits = number_text(value, decimals_);
    group(code, digits.find('.') == std::string::npos ? digits + ".0" : digits);
}

void DxfText::point(const Vec2& p, int n) {
    number(10 + n, p.x());
    number(20 + n, p.y());
}

void DxfText::begin_section(const std::string& name) {
    group(0, "SECTION");
    group(2, name);
}

void DxfText::polyline(const std::string& layer, const DrawingPolyline& line) {
    DxfText vertices(decimals_);
    int count = 0;
    for (const std::string& vertex : point_texts(line, [&](const Vec2& p) {
             DxfText one(decimals_);
             one.group(0, "VERTEX");
             one.group(8, layer);
             one.point(p);
             return one.bytes_;
         })) {
        vertices.bytes_ += vertex;
        ++count;
    }
    if (count < 2)
        return;
    group(0, "POLYLINE");
    group(8, layer);
    group(66, "1");
    point(Vec2::Zero());
    number(30, 0.0);
    group(70, line.closed ? "1" : "0");
    bytes_ += vertices.bytes_;
    group(0, "SEQEND");
    group(8, layer);
}

void DxfText::line(const std::string& layer, const Vec2& from, const Vec2& to) {
    group(0, "LINE");
    group(8, layer);
    point(from);
    point(to, 1);
}

void DxfText::text(const std::string& layer, const DrawingText& text) {
    group(0, "TEXT");
    group(8, layer);
    point(text_start(text));
    number(40, capital_height * text.size);
    group(1, ascii(text.text));
    if (text.angle != 0.0)
        number(50, degrees_per_radian * text.angle);
    if (text.anchor == TextAnchor::middle) { // centred on the baseline
        group(72, "1");
        point(text_baseline(text), 1);
    }
}

} // namespace devseg
