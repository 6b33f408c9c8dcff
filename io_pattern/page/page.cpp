#include "page/page.h"

#include <map>

#include <QByteArray>
#include <QString>

#include "page/model_data.h"
#include "writers/svg_writer.h"

extern "C" {
extern const char devseg_page_html[];
extern const char devseg_page_html_end[];
extern const char devseg_page_css[];
extern const char devseg_page_css_end[];
extern const char devseg_page_js[];
extern const char devseg_page_js_end[];
extern const char devseg_page_three[];
extern const char devseg_page_three_end[];
extern const char devseg_page_three_license[];
extern const char devseg_page_three_license_end[];
}

namespace devseg::page {

namespace {

QByteArray resource(const char* begin, const char* end) {
    return QByteArray(begin, static_cast<int>(end - begin));
}

// A script ends at the first "</script": in data it must not appear.
QByteArray in_script(QByteArray text) {
    return text.replace("</", "<\\/");
}

// The drawing as an element of the page: without the head of a file.
QByteArray svg_element(const writers::Drawing& drawing) {
    const QByteArray svg = QByteArray::fromStdString(writers::svg_bytes(drawing));
    return svg.mid(svg.indexOf("<svg"));
}

QByteArray escaped(const std::string& utf8) {
    return QString::fromStdString(utf8).toHtmlEscaped().toUtf8();
}

} // namespace

std::string page_bytes(const pattern::Pattern& pattern, const sheet::PatternLayout& layout,
                       const sheet::ExportOptions& options, const std::string& title,
                       const Progress& progress) {
    sheet::ExportOptions drawn = options;
    drawn.group = sheet::Grouping::piece;
    drawn.frame = drawn.scale_check = false; // the page draws its own
    const writers::Drawing drawing = sheet::draw_sheets(layout, drawn);
    progress.check();
    const std::map<QByteArray, QByteArray> parts = {
        {"title", escaped(title)},
        {"css", resource(devseg_page_css, devseg_page_css_end)},
        {"drawing", svg_element(drawing)},
        {"license", resource(devseg_page_three_license, devseg_page_three_license_end)},
        {"data", in_script(model_data(pattern, layout, options, drawing, title, progress))},
        {"three", resource(devseg_page_three, devseg_page_three_end)},
        {"script", resource(devseg_page_js, devseg_page_js_end)}};
    // From place to place in the frame: what a part holds is no place for another.
    const QByteArray frame = resource(devseg_page_html, devseg_page_html_end);
    QByteArray bytes;
    int from = 0;
    for (int open = frame.indexOf("{{"); open >= 0; open = frame.indexOf("{{", from)) {
        const int close = frame.indexOf("}}", open);
        bytes += frame.mid(from, open - from) + parts.at(frame.mid(open + 2, close - open - 2));
        from = close + 2;
    }
    return (bytes + frame.mid(from)).toStdString();
}

} // namespace devseg::page
