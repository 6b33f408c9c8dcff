// References
//   ISO 32000-1:2008, Portable document format, PDF 1.7: file structure (7.5), strings (7.3.4).
#include "writers/pdf_objects.h"

#include <algorithm>

#include <QByteArray>
#include <QString>

namespace devseg::writers {

namespace {

std::string padded(std::size_t value, std::size_t digits) {
    const std::string text = std::to_string(value);
    return std::string(digits - std::min(digits, text.size()), '0') + text;
}

} // namespace

int PdfObjects::reserve() {
    bodies_.emplace_back();
    return static_cast<int>(bodies_.size());
}

void PdfObjects::define(int number, const std::string& body) {
    bodies_[static_cast<std::size_t>(number - 1)] = body;
}

int PdfObjects::add(const std::string& body) {
    const int number = reserve();
    define(number, body);
    return number;
}

int PdfObjects::add_stream(const std::string& entries, const std::string& data) {
    // Qt puts the size in front of what zlib makes, as four bytes.
    const QByteArray packed =
        qCompress(reinterpret_cast<const uchar*>(data.data()), static_cast<int>(data.size()))
            .mid(4);
    return add_packed(entries + " /Filter /FlateDecode", packed.toStdString());
}

int PdfObjects::add_packed(const std::string& entries, const std::string& data) {
    return add("<< " + entries + " /Length " + std::to_string(data.size()) + " >>\nstream\n" +
               data + "\nendstream");
}

std::string PdfObjects::file(int catalogue, int information) const {
    // The second line tells programs that move files that this one is not plain text.
    std::string bytes = "%PDF-1.6\n%\xe2\xe3\xcf\xd3\n";
    std::string table = "0000000000 65535 f \n";
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        table += padded(bytes.size(), 10) + " 00000 n \n";
        bytes += std::to_string(i + 1) + " 0 obj\n" + bodies_[i] + "\nendobj\n";
    }
    const std::string size = std::to_string(bodies_.size() + 1);
    const std::size_t start = bytes.size();
    return bytes + "xref\n0 " + size + '\n' + table + "trailer\n<< /Size " + size + " /Root " +
           reference(catalogue) + " /Info " + reference(information) + " >>\nstartxref\n" +
           std::to_string(start) + "\n%%EOF\n";
}

std::string PdfObjects::literal(const std::string& bytes) {
    std::string text = "(";
    for (const char c : bytes) {
        if (c == '(' || c == ')' || c == '\\')
            text += '\\';
        text += c;
    }
    return text + ')';
}

std::string PdfObjects::text(const std::string& utf8) {
    static const char* const digits = "0123456789ABCDEF";
    std::string hex = "<FEFF";
    for (const QChar c : QString::fromStdString(utf8))
        for (int shift = 12; shift >= 0; shift -= 4)
            hex += digits[(c.unicode() >> shift) & 15];
    return hex + '>';
}

} // namespace devseg::writers
