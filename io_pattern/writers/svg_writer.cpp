// References
//   W3C: Scalable Vector Graphics (SVG) 1.1, second edition. 2011.
//   Layers: attributes groupmode and label of Inkscape's namespace.
#include "writers/svg_writer.h"

#include <algorithm>

#include <QByteArray>
#include <QString>
#include <QXmlStreamWriter>

#include "writers/jpeg.h"
#include "writers/text.h"

namespace devseg::writers {

namespace {

const char* const svg_namespace = "http://www.w3.org/2000/svg";
const char* const inkscape_namespace = "http://www.inkscape.org/namespaces/inkscape";
const char* const sodipodi_namespace = "http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd";

const char* const xlink_namespace = "http://www.w3.org/1999/xlink";

const char* const all = "*"; // no piece has this name

constexpr double stroke_width = 0.1; // mm, a hairline that viewers still show

class Writer {
public:
    explicit Writer(const Drawing& drawing)
        : drawing_(drawing), photographs_(jpeg_files(drawing.images)), xml_(&bytes_) {
        xml_.setAutoFormatting(true);
        xml_.setAutoFormattingIndent(1);
    }

    QByteArray write() {
        xml_.writeStartDocument();
        xml_.writeDefaultNamespace(svg_namespace);
        xml_.writeNamespace(inkscape_namespace, "inkscape");
        xml_.writeNamespace(sodipodi_namespace, "sodipodi");
        if (!drawing_.images.empty())
            xml_.writeNamespace(xlink_namespace, "xlink");
        xml_.writeStartElement(svg_namespace, "svg");
        const QString width = number(drawing_.width);
        const QString height = number(drawing_.height);
        xml_.writeAttribute("version", "1.1");
        xml_.writeAttribute("width", width + "mm");
        xml_.writeAttribute("height", height + "mm");
        xml_.writeAttribute("viewBox", "0 0 " + width + ' ' + height);
        write_view();
        if (drawing_.by_piece)
            for (const std::string& piece : owners())
                write_piece(piece);
        write_images("", drawing_.by_piece ? "" : all);
        for (const DrawingLayer& layer : drawing_.layers)
            write_layer(layer, "", drawing_.by_piece ? "" : all);
        xml_.writeEndDocument();
        return bytes_;
    }

private:
    // Inkscape's pages; others skip them.
    void write_view() {
        xml_.writeStartElement(sodipodi_namespace, "namedview");
        xml_.writeAttribute(inkscape_namespace, "document-units", "mm");
        for (const DrawingSheet& sheet : drawing_.pages) {
            xml_.writeEmptyElement(inkscape_namespace, "page");
            xml_.writeAttribute("x", number(sheet.low.x()));
            xml_.writeAttribute("y", number(drawing_.height - sheet.low.y() - sheet.size.y()));
            xml_.writeAttribute("width", number(sheet.size.x()));
            xml_.writeAttribute("height", number(sheet.size.y()));
        }
        xml_.writeEndElement();
    }

    // Pieces in the order in which they are cut.
    std::vector<std::string> owners() const {
        std::vector<std::string> names;
        for (const DrawingLayer& layer : drawing_.layers)
            for (const DrawingPath& path : layer.paths)
                if (!path.owner.empty() &&
                    std::find(names.begin(), names.end(), path.owner) == names.end())
                    names.push_back(path.owner);
        return names;
    }

    // Everything of one piece, by operation: it moves as one.
    void write_piece(const std::string& piece) {
        begin_layer(piece, piece);
        write_images(piece + '-', piece);
        for (const DrawingLayer& layer : drawing_.layers)
            write_layer(layer, piece + '-', piece);
        xml_.writeEndElement();
    }

    void begin_layer(const std::string& id, const std::string& label) {
        xml_.writeStartElement(svg_namespace, "g");
        xml_.writeAttribute("id", text(id));
        xml_.writeAttribute(inkscape_namespace, "groupmode", "layer");
        xml_.writeAttribute(inkscape_namespace, "label", text(label));
    }

    // The images of one piece, of none (""), or all of them, each inside of its rings.
    void write_images(const std::string& prefix, const std::string& piece) {
        bool any = false;
        for (std::size_t i = 0; i < drawing_.images.size(); ++i) {
            const DrawingImage& image = drawing_.images[i];
            if (piece != all && image.owner != piece)
                continue;
            if (!any)
                begin_layer(prefix + image_layer + (prefix.empty() ? "" : "-layer"), image_label);
            any = true;
            const QString clip = text(image.owner + "-clip-" + std::to_string(++clips_));
            xml_.writeStartElement(svg_namespace, "clipPath");
            xml_.writeAttribute("id", clip);
            xml_.writeEmptyElement(svg_namespace, "path");
            QString d;
            for (const DrawingPolyline& ring : image.clip)
                append(ring, d);
            xml_.writeAttribute("d", d);
            xml_.writeAttribute("clip-rule", "evenodd");
            xml_.writeEndElement();
            xml_.writeEmptyElement(svg_namespace, "image");
            xml_.writeAttribute("x", number(image.low.x()));
            xml_.writeAttribute("y", number(drawing_.height - image.low.y() - image.size.y()));
            xml_.writeAttribute("width", number(image.size.x()));
            xml_.writeAttribute("height", number(image.size.y()));
            xml_.writeAttribute("preserveAspectRatio", "none");
            xml_.writeAttribute("clip-path", "url(#" + clip + ')');
            xml_.writeAttribute(
                xlink_namespace, "href",
                "data:image/jpeg;base64," +
                    QString::fromLatin1(QByteArray::fromStdString(photographs_[i]).toBase64()));
        }
        if (any)
            xml_.writeEndElement();
    }

    // What belongs to one piece, to none (""), or all of it.
    void write_layer(const DrawingLayer& layer, const std::string& prefix,
                     const std::string& piece) {
        const auto is_wanted = [&](const auto& item) {
            return piece == all || item.owner == piece;
        };
        if (std::none_of(layer.paths.begin(), layer.paths.end(), is_wanted) &&
            std::none_of(layer.texts.begin(), layer.texts.end(), is_wanted))
            return;
        begin_layer(prefix + layer.id + (prefix.empty() ? "" : "-layer"), layer.label);
        for (const DrawingPath& path : layer.paths)
            if (is_wanted(path))
                write_path(path, layer);
        for (const DrawingText& item : layer.texts)
            if (is_wanted(item))
                write_text(item, layer);
        xml_.writeEndElement();
    }

    // Attributes on each path and no style sheet: many cutters read nothing else.
    void write_path(const DrawingPath& path, const DrawingLayer& layer) {
        xml_.writeEmptyElement(svg_namespace, "path");
        if (!path.id.empty())
            xml_.writeAttribute("id", text(path.id));
        QString d;
        for (const DrawingPolyline& part : path.parts)
            append(part, d);
        xml_.writeAttribute("d", d);
        xml_.writeAttribute("fill", "none");
        xml_.writeAttribute("stroke", text(layer.colour));
        xml_.writeAttribute("stroke-width", number(stroke_width));
        if (!layer.dash.empty()) {
            QString lengths;
            for (const double length : layer.dash)
                lengths += (lengths.isEmpty() ? "" : " ") + number(length);
            xml_.writeAttribute("stroke-dasharray", lengths);
        }
    }

    void write_text(const DrawingText& item, const DrawingLayer& layer) {
        xml_.writeStartElement(svg_namespace, "text");
        const Vec2 baseline = text_baseline(item);
        const QString x = number(baseline.x());
        const QString y = number(drawing_.height - baseline.y());
        xml_.writeAttribute("x", x);
        xml_.writeAttribute("y", y);
        if (item.angle != 0.0)
            xml_.writeAttribute("transform", "rotate(" + number(-degrees_per_radian * item.angle) +
                                                 ' ' + x + ' ' + y + ')');
        xml_.writeAttribute("font-family", "Helvetica, Arial, sans-serif");
        xml_.writeAttribute("font-size", number(item.size));
        if (item.anchor == TextAnchor::middle)
            xml_.writeAttribute("text-anchor", "middle");
        xml_.writeAttribute("fill", text(layer.colour));
        xml_.writeCharacters(text(item.text));
        xml_.writeEndElement();
    }

    QString point(const Vec2& p) const {
        return number(p.x()) + ',' + number(drawing_.height - p.y());
    }

    void append(const std::vector<DrawingCurve>& curves, QString& d) const {
        d += (d.isEmpty() ? "M " : " M ") + point(curves.front().control[0]);
        for (const DrawingCurve& curve : curves) {
            const auto& c = curve.control;
            d += curve.is_line ? " L " + point(c[3])
                               : " C " + point(c[1]) + ' ' + point(c[2]) + ' ' + point(c[3]);
        }
    }

    void append(const DrawingPolyline& line, QString& d) const {
        if (!line.curves.empty()) {
            append(line.curves, d);
            if (line.closed)
                d += " Z";
            return;
        }
        const char* step = d.isEmpty() ? "M " : " M ";
        for (const std::string& point : point_texts(line, [&](const Vec2& p) {
                 return number_text(p.x(), drawing_.decimals) + ',' +
                        number_text(drawing_.height - p.y(), drawing_.decimals);
             })) {
            d += step + QString::fromStdString(point);
            step = " L ";
        }
        if (line.closed && !line.points.empty())
            d += " Z";
    }

    QString number(double value) const {
        return QString::fromStdString(number_text(value, drawing_.decimals));
    }

    // XML has no way to write control characters.
    static QString text(const std::string& utf8) {
        QString result = QString::fromStdString(utf8);
        for (QChar& c : result)
            if (c.unicode() < 0x20)
                c = QChar(' ');
        return result;
    }

    const Drawing& drawing_;
    std::vector<std::string> photographs_; // of each image
    QByteArray bytes_;
    QXmlStreamWriter xml_;
    int clips_ = 0;
};

} // namespace

std::string svg_bytes(const Drawing& drawing) {
    return Writer(drawing).write().toStdString();
}

} // namespace devseg::writers
