// References
//   ISO 32000-1:2008, Portable document format, PDF 1.7: content streams (8), form XObjects
//   (8.10), optional content (8.11), text (9), viewer preferences (12.2).
#include "writers/pdf_writer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "writers/font.h"
#include "writers/jpeg.h"
#include "writers/pdf_objects.h"
#include "writers/text.h"

namespace devseg::writers {

namespace {

constexpr double points_per_mm = 72.0 / 25.4;
constexpr double largest_page = 14400.0; // user units, what readers take
constexpr int scale_decimals = 8;        // of factors, that multiply lengths of metres

struct WideFont {
    int object = 0;
    std::map<int, unsigned> glyphs; // with their code points
};

class Writer {
public:
    explicit Writer(const Document& document) : document_(document) {}

    std::string write() {
        const int catalogue = objects_.reserve();
        tree_ = objects_.reserve();
        font_ = objects_.add("<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica "
                             "/Encoding /WinAnsiEncoding >>");
        reserve_wide_fonts();
        declare_layers();
        std::string objects;
        const std::string pattern = pictures(objects) + content(document_.drawing.layers);
        form_ = objects_.add_stream(
            "/Type /XObject /Subtype /Form /BBox [0 0 " + millimetres(document_.drawing.width) +
                ' ' + millimetres(document_.drawing.height) + "] /Resources " + resources(objects),
            pattern);
        std::string kids;
        for (const DocumentPage& page : document_.pages)
            kids += PdfObjects::reference(add_page(page)) + ' ';
        for (const auto& [number, used] : wide_fonts_)
            define_wide_font(built_in_fonts()[number], used);
        objects_.define(tree_, "<< /Type /Pages /Count " + std::to_string(document_.pages.size()) +
                                   " /Kids [" + kids + "] >>");
        objects_.define(catalogue, "<< /Type /Catalog /Pages " + PdfObjects::reference(tree_) +
                                       " /ViewerPreferences << /PrintScaling /None >> "
                                       "/OCProperties << /OCGs [" +
                                       groups_ + "] /D << /Order [" + groups_ + "] /ON [" +
                                       groups_ + "] >> >> >>");
        const int information = objects_.add("<< /Title " + PdfObjects::text(document_.title) +
                                             " /Producer (devseg) >>");
        return objects_.file(catalogue, information);
    }

private:
    // Only those fonts get into the file whose glyphs are used.
    void reserve_wide_fonts() {
        const auto reserve = [&](const DrawingLayer& layer) {
            for (const DrawingText& text : layer.texts)
                for (const unsigned point :
                     needs_font(text.text) ? code_points(text.text) : std::vector<unsigned>())
                    if (const auto [font, is_new] = wide_fonts_.try_emplace(glyph_of(point).font);
                        is_new)
                        font->second.object = objects_.reserve();
        };
        for (const DrawingLayer& layer : document_.drawing.layers)
            reserve(layer);
        for (const DocumentPage& page : document_.pages)
            for (const DrawingLayer& layer : page.marks)
                reserve(layer);
    }

    // The glyphs that are used, under their numbers, with a map back for who copies text.
    void define_wide_font(const Font& font, const WideFont& used) {
        const auto thousandths = [](double sizes) { return number_text(1000.0 * sizes, 0); };
        std::set<int> glyphs;
        std::string widths;
        std::string map;
        for (const auto& [glyph, point] : used.glyphs) {
            glyphs.insert(glyph);
            widths += std::to_string(glyph) + " [" + thousandths(font.advance(glyph)) + "] ";
            map += '<' + hex(static_cast<unsigned>(glyph)) + "> <" + hex(point) + ">\n";
        }
        const std::string data = font.subset(glyphs);
        const int file = objects_.add_stream("/Length1 " + std::to_string(data.size()), data);
        const std::string name = "/BaseFont /DEVSEG+" + font.name();
        const auto corner = [&](const Vec2& p) {
            return thousandths(p.x()) + ' ' + thousandths(p.y());
        };
        const int descriptor = objects_.add(
            "<< /Type /FontDescriptor /FontName /DEVSEG+" + font.name() + " /Flags 32 /FontBBox [" +
            corner(font.box().min()) + ' ' + corner(font.box().max()) +
            "] /ItalicAngle 0 /Ascent " + thousandths(font.ascent()) + " /Descent " +
            thousandths(font.descent()) + " /CapHeight " + thousandths(capital_height) +
            " /StemV 80 /FontFile2 " + PdfObjects::reference(file) + " >>");
        const int glyph_font = objects_.add(
            "<< /Type /Font /Subtype /CIDFontType2 " + name +
            " /CIDSystemInfo << /Registry (Adobe) /Ordering (Identity) /Supplement 0 >> "
            "/CIDToGIDMap /Identity /DW 600 /W [" +
            widths + "] /FontDescriptor " + PdfObjects::reference(descriptor) + " >>");
        const int unicode = objects_.add_stream(
            "", "/CIDInit /ProcSet findresource begin 12 dict begin begincmap\n/CMapName /devseg "
                "def\n/CMapType 2 def\n1 begincodespacerange <0000> <FFFF> endcodespacerange\n" +
                    std::to_string(used.glyphs.size()) + " beginbfchar\n" + map +
                    "endbfchar\nendcmap CMapName currentdict /CMap defineresource pop end end\n");
        objects_.define(used.object, "<< /Type /Font /Subtype /Type0 " + name +
                                         " /Encoding /Identity-H /DescendantFonts [" +
                                         PdfObjects::reference(glyph_font) + "] /ToUnicode " +
                                         PdfObjects::reference(unicode) + " >>");
    }

    // UTF-16, big-endian.
    static std::string hex(unsigned point) {
        const auto digits = [](unsigned value) {
            static const char* const names = "0123456789ABCDEF";
            std::string four;
            for (int shift = 12; shift >= 0; shift -= 4)
                four += names[value >> shift & 15U];
            return four;
        };
        if (point < 0x10000)
            return digits(point);
        return digits(0xd800 + ((point - 0x10000) >> 10)) + digits(0xdc00 + (point & 0x3ffU));
    }

    // Operators that choose fonts and show the text.
    std::string shown_text(const std::string& utf8, double size) {
        const std::string chosen = ' ' + millimetres(size) + " Tf ";
        if (!needs_font(utf8))
            return "/F1" + chosen + PdfObjects::literal(latin1(utf8)) + " Tj ";
        std::string text;
        std::size_t font = built_in_fonts().size();
        for (const unsigned point : code_points(utf8)) {
            const Glyph glyph = glyph_of(point);
            if (glyph.font != font)
                text += (text.empty() ? "" : "> Tj ") + wide_name(glyph.font) + chosen + '<';
            font = glyph.font;
            wide_fonts_.at(font).glyphs.emplace(glyph.number, point);
            text += hex(static_cast<unsigned>(glyph.number));
        }
        return text + "> Tj ";
    }

    static std::string wide_name(std::size_t font) { return "/F" + std::to_string(font + 2); }

    // A layer of the same id is the same group on all pages.
    void declare_layers() {
        const auto declare = [&](const DrawingLayer& layer) {
            if ((layer.paths.empty() && layer.texts.empty()) ||
                !layer_numbers_.emplace(layer.id, layer_numbers_.size()).second)
                return;
            const std::string group = PdfObjects::reference(
                objects_.add("<< /Type /OCG /Name " + PdfObjects::text(layer.label) + " >>"));
            properties_ += "/L" + std::to_string(layer_numbers_.size() - 1) + ' ' + group + ' ';
            groups_ += group + ' ';
        };
        if (!document_.drawing.images.empty())
            declare({image_layer, image_label, "", {}, {DrawingPath()}, {}});
        for (const DrawingLayer& layer : document_.drawing.layers)
            declare(layer);
        for (const DocumentPage& page : document_.pages)
            for (const DrawingLayer& layer : page.marks)
                declare(layer);
    }

    std::string resources(const std::string& objects) const {
        std::string wide;
        for (const auto& [number, used] : wide_fonts_)
            wide += ' ' + wide_name(number) + ' ' + PdfObjects::reference(used.object);
        return "<< /Font << /F1 " + PdfObjects::reference(font_) + wide + " >> /Properties << " +
               properties_ + ">> /XObject << " + objects + ">> >>";
    }

    // All content is in millimetres: the page's first operator scales.
    int add_page(const DocumentPage& page) {
        std::string objects = "/Pattern " + PdfObjects::reference(form_) + ' ';
        const double unit =
            std::ceil(points_per_mm * std::max(page.width, page.height) / largest_page);
        const double scale = points_per_mm / unit;
        std::string data = factor(scale) + " 0 0 " + factor(scale) + " 0 0 cm\n";
        for (std::size_t i = 0; i < page.images.size(); ++i) {
            const std::string name = "/Image" + std::to_string(i);
            objects += name + ' ' + PdfObjects::reference(add_image(page.images[i])) + ' ';
            data += "q " + millimetres(page.images[i].size.x()) + " 0 0 " +
                    millimetres(page.images[i].size.y()) + ' ' + point(page.images[i].low) +
                    " cm " + name + " Do Q\n";
        }
        for (const PageWindow& window : page.windows) {
            const Vec2 shift = window.position - window.scale * window.low;
            data += "q " + point(window.position) + ' ' + point(window.scale * window.size) +
                    " re W n " + factor(window.scale) + " 0 0 " + factor(window.scale) + ' ' +
                    point(shift) + " cm /Pattern Do Q\n";
        }
        data += content(page.marks);
        const int stream = objects_.add_stream("", data);
        return objects_.add("<< /Type /Page /Parent " + PdfObjects::reference(tree_) +
                            " /UserUnit " + number_text(unit, 0) + " /MediaBox [0 0 " +
                            factor(scale * page.width) + ' ' + factor(scale * page.height) +
                            "] /Resources " + resources(objects) + " /Contents " +
                            PdfObjects::reference(stream) + " >>");
    }

    // The images of the drawing, each inside of its rings.
    std::string pictures(std::string& objects) {
        std::string data;
        const std::vector<std::string> photographs = jpeg_files(document_.drawing.images);
        for (std::size_t i = 0; i < photographs.size(); ++i) {
            const DrawingImage& image = document_.drawing.images[i];
            const std::string name = "/Picture" + std::to_string(i);
            objects +=
                name + ' ' + PdfObjects::reference(add_photograph(image, photographs[i])) + ' ';
            data += "q ";
            for (const DrawingPolyline& ring : image.clip)
                data += outline(ring);
            if (!image.clip.empty())
                data += "W* n ";
            data += millimetres(image.size.x()) + " 0 0 " + millimetres(image.size.y()) + ' ' +
                    point(image.low) + " cm " + name + " Do Q\n";
        }
        if (data.empty())
            return data;
        return "/OC /L" + std::to_string(layer_numbers_.at(image_layer)) + " BDC\n" + data +
               "EMC\n";
    }

    int add_photograph(const DrawingImage& image, const std::string& jpeg) {
        return objects_.add_packed("/Type /XObject /Subtype /Image /ColorSpace /DeviceRGB "
                                   "/BitsPerComponent 8 /Filter /DCTDecode /Width " +
                                       std::to_string(image.columns) + " /Height " +
                                       std::to_string(image.rows),
                                   jpeg);
    }

    int add_image(const DrawingImage& image) {
        return objects_.add_stream("/Type /XObject /Subtype /Image /ColorSpace /DeviceRGB "
                                   "/BitsPerComponent 8 /Width " +
                                       std::to_string(image.columns) + " /Height " +
                                       std::to_string(image.rows),
                                   std::string(image.rgb.begin(), image.rgb.end()));
    }

    std::string content(const std::vector<DrawingLayer>& layers) {
        std::string data = millimetres(line_width) + " w 1 j 1 J\n";
        for (const DrawingLayer& layer : layers) {
            if (layer.paths.empty() && layer.texts.empty())
                continue;
            data += "/OC /L" + std::to_string(layer_numbers_.at(layer.id)) + " BDC q\n" +
                    colour(layer.colour) + " RG " + colour(layer.colour) + " rg [";
            for (const double length : layer.dash)
                data += millimetres(length) + ' ';
            data += "] 0 d\n";
            for (const DrawingPath& path : layer.paths)
                append(path, data);
            for (const DrawingText& text : layer.texts)
                append(text, data);
            data += "Q EMC\n";
        }
        return data;
    }

    void append(const DrawingPath& path, std::string& data) const {
        for (const DrawingPolyline& line : path.parts) {
            if (!line.curves.empty())
                data += point(line.curves.front().control[0]) + " m ";
            for (const DrawingCurve& curve : line.curves) {
                const auto& c = curve.control;
                data += curve.is_line ? point(c[3]) + " l "
                                      : point(c[1]) + ' ' + point(c[2]) + ' ' + point(c[3]) + " c ";
            }
            if (!line.curves.empty()) {
                data += line.closed ? "h " : "";
                continue;
            }
            data += outline(line);
        }
        data += "S\n";
    }

    std::string outline(const DrawingPolyline& line) const {
        std::string data;
        const char* step = " m ";
        for (const std::string& text : point_texts(line, [&](const Vec2& p) { return point(p); })) {
            data += text + step;
            step = " l ";
        }
        return line.closed ? data + "h " : data;
    }

    void append(const DrawingText& text, std::string& data) {
        const double c = std::cos(text.angle);
        const double s = std::sin(text.angle);
        data += "BT " + factor(c) + ' ' + factor(s) + ' ' + factor(-s) + ' ' + factor(c) + ' ' +
                point(text_start(text)) + " Tm " + shown_text(text.text, text.size) + "ET\n";
    }

    static std::string colour(const std::string& code) {
        std::string text;
        for (const std::size_t channel : {1u, 3u, 5u})
            text += (text.empty() ? "" : " ") +
                    number_text(std::stoi(code.substr(channel, 2), nullptr, 16) / 255.0, 3);
        return text;
    }

    std::string millimetres(double value) const {
        return number_text(value, document_.drawing.decimals);
    }
    static std::string factor(double value) { return number_text(value, scale_decimals); }
    std::string point(const Vec2& p) const { return millimetres(p.x()) + ' ' + millimetres(p.y()); }

    const Document& document_;
    PdfObjects objects_;
    std::map<std::string, std::size_t> layer_numbers_;
    std::string groups_;     // references to all layers
    std::string properties_; // the same by name, for content
    int tree_ = 0;
    int font_ = 0;
    std::map<std::size_t, WideFont> wide_fonts_; // those of the built-in fonts that are used
    int form_ = 0;
};

} // namespace

std::string pdf_bytes(const Document& document) {
    return Writer(document).write();
}

} // namespace devseg::writers
