#include "writers/dxf_writer.h"

#include <array>
#include <cctype>
#include <cmath>
#include <limits>

#include "writers/dxf_text.h"
#include "writers/text_metrics.h"

namespace devseg {

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

int nearest_colour(const std::string& code) {
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

// Layer names of release 12: capital letters, digits and underscores.
std::string layer_name(const DrawingLayer& layer) {
    std::string name;
    for (const char c : ascii(layer.label))
        name += std::isalnum(static_cast<unsigned char>(c)) != 0
                    ? static_cast<char>(std::toupper(static_cast<unsigned char>(c)))
                    : '_';
    return name;
}

void write_line_type(DxfText& file, const std::string& name, const std::string& look,
                     const std::vector<double>& strokes) {
    file.group(0, "LTYPE");
    file.group(2, name);
    file.group(70, "64");
    file.group(3, look);
    file.group(72, "65");
    file.count(73, static_cast<int>(strokes.size()));
    double length = 0.0;
    for (const double stroke : strokes)
        length += std::abs(stroke);
    file.number(40, length);
    for (const double stroke : strokes)
        file.number(49, stroke);
}

void write_tables(DxfText& file, const std::vector<const DrawingLayer*>& layers) {
    file.begin_section("TABLES");
    file.group(0, "TABLE");
    file.group(2, "LTYPE");
    file.group(70, "2");
    write_line_type(file, "CONTINUOUS", "Solid line", {});
    write_line_type(file, "DASHED", "__ __ __ __", {3.0, -1.5});
    file.group(0, "ENDTAB");
    file.group(0, "TABLE");
    file.group(2, "LAYER");
    file.count(70, static_cast<int>(layers.size()));
    for (const DrawingLayer* layer : layers) {
        file.group(0, "LAYER");
        file.group(2, layer_name(*layer));
        file.group(70, "0");
        file.count(62, nearest_colour(layer->colour));
        file.group(6, layer->dash.empty() ? "CONTINUOUS" : "DASHED");
    }
    file.group(0, "ENDTAB");
    file.end_section();
}

} // namespace

std::string dxf_bytes(const Drawing& drawing) {
    std::vector<const DrawingLayer*> layers;
    for (const DrawingLayer& layer : drawing.layers)
        if (!layer.paths.empty() || !layer.texts.empty())
            layers.push_back(&layer);
    DxfText file(drawing.decimals);
    file.begin_section("HEADER");
    file.group(9, "$ACADVER");
    file.group(1, "AC1009");
    file.group(9, "$EXTMIN");
    file.point(Vec2::Zero());
    file.group(9, "$EXTMAX");
    file.point(Vec2(drawing.width, drawing.height));
    file.end_section();
    write_tables(file, layers);
    file.begin_section("ENTITIES");
    for (const DrawingLayer* layer : layers) {
        for (const DrawingPath& path : layer->paths)
            for (const DrawingPolyline& part : path.parts)
                file.polyline(layer_name(*layer), part);
        for (const DrawingText& text : layer->texts)
            file.text(layer_name(*layer), text);
    }
    file.end_section();
    return file.file();
}

} // namespace devseg
