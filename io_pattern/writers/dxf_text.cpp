// References
//   Autodesk: AutoCAD release 12 customization manual, drawing interchange files. 1992.
#include "writers/dxf_text.h"

#include <cctype>
#include <limits>

#include "writers/text.h"

namespace devseg::writers {

namespace {

// The seven colours that all programs show alike, by their number.
struct IndexedColour {
    int number;
    std::array<int, 3> rgb;
};
constexpr std::array<IndexedColour, 7> indexed_colours = {{{1, {255, 0, 0}},
                                                           {2, {255, 255, 0}},
                                                           {3, {0, 255, 0}},
                                                           {4, {0, 255, 255}},
                                                           {5, {0, 0, 255}},
                                                           {6, {255, 0, 255}},
                                                           {7, {0, 0, 0}}}};

} // namespace

int dxf_colour(const std::string& code) {
    int best = 0;
    int least = std::numeric_limits<int>::max();
    for (const IndexedColour& colour : indexed_colours) {
        int distance = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const int channel = std::stoi(code.substr(1 + 2 * k, 2), nullptr, 16);
            distance += (channel - colour.rgb[k]) * (channel - colour.rgb[k]);
        }
        if (distance < least) {
            least = distance;
            best = colour.number;
        }
    }
    return best;
}

std::string dxf_layer_name(const DrawingLayer& layer) {
    std::string name;
    for (const char c : ascii(layer.label))
        name += std::isalnum(static_cast<unsigned char>(c)) != 0
                    ? static_cast<char>(std::toupper(static_cast<unsigned char>(c)))
                    : '_';
    return name;
}

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
    text_content(text);
}

void DxfText::text_content(const DrawingText& text) {
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

} // namespace devseg::writers
