// Any drawing as SVG, DXF and PDF.
#include <cmath>

#include "fuzz/bytes.h"
#include "writers/dxf_writer.h"
#include "writers/pdf_writer.h"
#include "writers/svg_writer.h"

namespace devseg::fuzz {

namespace {

// The writers ask for finite numbers.
double finite(Bytes& bytes) {
    const double value = bytes.number();
    return std::isfinite(value) ? value : 0.0;
}

Vec2 place(Bytes& bytes) {
    const double x = finite(bytes);
    return Vec2(x, finite(bytes));
}

writers::DrawingLayer read_layer(Bytes& bytes) {
    writers::DrawingLayer layer;
    layer.id = bytes.text(8);
    layer.label = bytes.text(20);
    layer.colour = "#12aBfF";
    for (int i = bytes.below(3); i > 0; --i)
        layer.dash.push_back(std::abs(finite(bytes)));
    for (int i = bytes.below(5); i > 0; --i) {
        writers::DrawingPath path;
        path.id = bytes.text(8);
        for (int k = bytes.below(3); k > 0; --k) {
            writers::DrawingPolyline line;
            line.closed = bytes.flag();
            for (int p = bytes.below(12); p > 0; --p)
                line.points.push_back(place(bytes));
            path.parts.push_back(line);
        }
        layer.paths.push_back(path);
    }
    for (int i = bytes.below(4); i > 0; --i) {
        const Vec2 position = place(bytes);
        const double size = std::abs(finite(bytes));
        const std::string text = bytes.text(30);
        layer.texts.push_back(
            {position, size, text, finite(bytes),
             bytes.flag() ? writers::TextAnchor::left : writers::TextAnchor::middle});
    }
    return layer;
}

writers::Drawing read_drawing(Bytes& bytes) {
    writers::Drawing drawing;
    drawing.width = std::abs(finite(bytes));
    drawing.height = std::abs(finite(bytes));
    drawing.decimals = bytes.below(10);
    for (int i = bytes.below(4); i > 0; --i)
        drawing.layers.push_back(read_layer(bytes));
    for (int i = bytes.below(3); i > 0; --i) {
        const Vec2 low = place(bytes);
        drawing.sheets.push_back({low, place(bytes).cwiseAbs()});
    }
    return drawing;
}

writers::DocumentPage read_page(Bytes& bytes) {
    writers::DocumentPage page;
    page.width = std::abs(finite(bytes));
    page.height = std::abs(finite(bytes));
    for (int i = bytes.below(3); i > 0; --i) {
        const Vec2 low = place(bytes);
        const Vec2 size = place(bytes);
        const Vec2 position = place(bytes);
        page.windows.push_back({low, size, position, finite(bytes)});
    }
    if (bytes.flag())
        page.marks.push_back(read_layer(bytes));
    if (bytes.flag()) {
        writers::DrawingImage image;
        image.columns = bytes.below(5);
        image.rows = bytes.below(5);
        for (int i = 0; i < 3 * image.columns * image.rows; ++i)
            image.rgb.push_back(bytes.byte());
        image.size = place(bytes);
        page.images.push_back(image);
    }
    return page;
}

} // namespace

} // namespace devseg::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace devseg;
    fuzz::Bytes bytes(data, size);
    writers::Document document;
    document.title = bytes.text(20);
    document.drawing = fuzz::read_drawing(bytes);
    for (int i = 1 + bytes.below(3); i > 0; --i)
        document.pages.push_back(fuzz::read_page(bytes));
    const std::string svg = writers::svg_bytes(document.drawing);
    if (svg.find("</svg>") == std::string::npos)
        fuzz::fail("SVG without an end");
    const std::string dxf = writers::dxf_bytes(document.drawing);
    if (dxf.find("EOF") == std::string::npos)
        fuzz::fail("DXF without an end");
    for (const char c : dxf)
        if (static_cast<unsigned char>(c) > 127)
            fuzz::fail("DXF that is not 7-bit");
    const std::string pdf = writers::pdf_bytes(document);
    if (pdf.compare(0, 5, "%PDF-") != 0 || pdf.find("%%EOF") == std::string::npos)
        fuzz::fail("PDF without begin or end");
    return 0;
}
