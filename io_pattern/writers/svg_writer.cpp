// References
//   W3C: Scalable Vector Graphics (SVG) 1.1, second edition. 2011.
//   Layers: attributes groupmode and label of Inkscape's namespace.
#include "writers/svg_writer.h"

#include <QByteArray>
#include <QFileInfo>
#include <QSaveFile>
#include <QString>
#include <QXmlStreamWriter>

#include "devseg/errors.h"

namespace devseg {

namespace {

const char* const svg_namespace = "http://www.w3.org/2000/svg";
const char* const inkscape_namespace = "http://www.inkscape.org/namespaces/inkscape";
const char* const sodipodi_namespace = "http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd";

constexpr double stroke_width = 0.1; // mm, a hairline that viewers still show

// From the middle of capital letters down to the baseline, in font sizes. Cutters do not know the
// attribute dominant-baseline.
constexpr double half_capital = 0.36;

class Writer {
public:
    explicit Writer(const Drawing& drawing) : drawing_(drawing), xml_(&bytes_) {
        xml_.setAutoFormatting(true);
        xml_.setAutoFormattingIndent(1);
    }

    QByteArray write() {
        xml_.writeStartDocument();
        xml_.writeDefaultNamespace(svg_namespace);
        xml_.writeNamespace(inkscape_namespace, "inkscape");
        xml_.writeNamespace(sodipodi_namespace, "sodipodi");
        xml_.writeStartElement(svg_namespace, "svg");
        const QString width = number(drawing_.width);
        const QString height = number(drawing_.height);
        xml_.writeAttribute("version", "1.1");
        xml_.writeAttribute("width", width + "mm");
        xml_.writeAttribute("height", height + "mm");
        xml_.writeAttribute("viewBox", "0 0 " + width + ' ' + height);
        xml_.writeEmptyElement(sodipodi_namespace, "namedview");
        xml_.writeAttribute(inkscape_namespace, "document-units", "mm");
        for (const DrawingLayer& layer : drawing_.layers)
            if (!layer.paths.empty() || !layer.texts.empty())
                write_layer(layer);
        xml_.writeEndDocument();
        return bytes_;
    }

private:
    void write_layer(const DrawingLayer& layer) {
        xml_.writeStartElement(svg_namespace, "g");
        xml_.writeAttribute("id", text(layer.id));
        xml_.writeAttribute(inkscape_namespace, "groupmode", "layer");
        xml_.writeAttribute(inkscape_namespace, "label", text(layer.label));
        for (const DrawingPath& path : layer.paths)
            write_path(path, layer);
        for (const DrawingText& item : layer.texts)
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
        const Vec2 baseline = item.centre - Vec2(0.0, half_capital * item.size);
        xml_.writeAttribute("x", number(baseline.x()));
        xml_.writeAttribute("y", number(drawing_.height - baseline.y()));
        xml_.writeAttribute("font-family", "sans-serif");
        xml_.writeAttribute("font-size", number(item.size));
        xml_.writeAttribute("text-anchor", "middle");
        xml_.writeAttribute("fill", text(layer.colour));
        xml_.writeCharacters(text(item.text));
        xml_.writeEndElement();
    }

    // Points that rounding puts onto the one before are left out: cutters stop at each point.
    void append(const DrawingPolyline& line, QString& d) const {
        QString first;
        QString last;
        for (const Vec2& p : line.points) {
            const QString point = number(p.x()) + ',' + number(drawing_.height - p.y());
            if (point == last || (&p == &line.points.back() && line.closed && point == first))
                continue;
            if (first.isEmpty())
                first = point;
            d += (d.isEmpty() ? "" : " ") + QString(last.isEmpty() ? "M " : "L ") + point;
            last = point;
        }
        if (line.closed && !last.isEmpty())
            d += " Z";
    }

    // QString::number knows no locale. Trailing zeros are cut, and so is the sign of -0.
    QString number(double value) const {
        QString digits = QString::number(value, 'f', drawing_.decimals);
        if (digits.contains('.')) {
            while (digits.endsWith('0'))
                digits.chop(1);
            if (digits.endsWith('.'))
                digits.chop(1);
        }
        return digits == QLatin1String("-0") ? QString("0") : digits;
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
    QByteArray bytes_;
    QXmlStreamWriter xml_;
};

[[noreturn]] void refuse(const QString& path, const QString& reason) {
    throw FileError("expected to write the file '" + path.toStdString() +
                    "', found: " + reason.toStdString() +
                    "; choose a folder that exists, can be written and has room");
}

} // namespace

std::string svg_bytes(const Drawing& drawing) {
    return Writer(drawing).write().toStdString();
}

void save_svg(const std::string& path, const Drawing& drawing) {
    const QString name = QString::fromStdString(path);
    const QByteArray bytes = Writer(drawing).write();
    QSaveFile file(name);
    if (!file.open(QIODevice::WriteOnly))
        refuse(name, file.errorString());
    if (file.write(bytes) != bytes.size() || !file.commit())
        refuse(name, file.errorString());
}

} // namespace devseg
