#include "writers/dxf_writer.h"

#include <algorithm>
#include <cmath>

#include "writers/dxf_splines.h"
#include "writers/dxf_text.h"

namespace devseg::writers {

namespace {

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
        file.group(2, dxf_layer_name(*layer));
        file.group(70, "0");
        file.count(62, dxf_colour(layer->colour));
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
    const auto has_curves = [](const DrawingLayer* layer) {
        return std::any_of(layer->paths.begin(), layer->paths.end(), [](const DrawingPath& path) {
            return std::any_of(path.parts.begin(), path.parts.end(),
                               [](const DrawingPolyline& part) { return !part.curves.empty(); });
        });
    };
    if (std::any_of(layers.begin(), layers.end(), has_curves))
        return dxf_bytes_with_splines(drawing, layers);
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
                file.polyline(dxf_layer_name(*layer), part);
        for (const DrawingText& text : layer->texts)
            file.text(dxf_layer_name(*layer), text);
    }
    file.end_section();
    return file.file();
}

} // namespace devseg::writers
