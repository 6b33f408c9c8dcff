// The skeleton of a PDF file: numbered objects, streams and the table of their places.
#pragma once

#include <string>
#include <vector>

namespace devseg::writers {

class PdfObjects {
public:
    /// A number for an object that is defined later.
    int reserve();
    void define(int number, const std::string& body);
    int add(const std::string& body);

    /// A compressed stream; `entries` of its dictionary beside length and filter.
    int add_stream(const std::string& entries, const std::string& data);

    /// The same for data that is compressed already: `entries` name the filter.
    int add_packed(const std::string& entries, const std::string& data);

    /// The whole file. Every reserved number must have been defined.
    std::string file(int catalogue, int information) const;

    static std::string reference(int number) { return std::to_string(number) + " 0 R"; }
    /// A string as dictionaries and texts hold it: bytes in parentheses.
    static std::string literal(const std::string& bytes);
    /// UTF-8 text for people, in a form that knows all scripts.
    static std::string text(const std::string& utf8);

private:
    std::vector<std::string> bodies_; // of object i + 1
};

} // namespace devseg::writers
