#include "writers/pdf_writer.h"

#include <clocale>

#include <gtest/gtest.h>

#include "writers/pdf_objects.h"
#include "writers/text.h"

namespace devseg::writers {
namespace {

Document small_document() {
    Document document;
    document.title = "n\xc3\xa4me (1)";
    document.drawing.width = 40;
    document.drawing.height = 30;
    DrawingLayer cut{"cut", "Cut", "#ff0000", {}, {}, {}};
    cut.paths.push_back({"P01-cut", {{{Vec2(10, 10), Vec2(30, 10), Vec2(30, 20)}, true}}});
    document.drawing.layers = {cut, {"empty", "Empty", "#0000ff", {}, {}, {}}};
    DocumentPage page;
    page.width = 100;
    page.height = 80;
    page.windows.push_back({Vec2::Zero(), Vec2(40, 30), Vec2(10, 10), 1.0});
    document.pages = {page, page};
    return document;
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (std::size_t i = text.find(part); i != std::string::npos; i = text.find(part, i + 1))
        ++found;
    return found;
}

// Every offset of the table must be the place where its object begins.
TEST(PdfWriter, TableOfPlacesIsTrue) {
    const std::string bytes = pdf_bytes(small_document());
    const std::size_t start = bytes.rfind("startxref\n") + 10;
    const std::size_t table = std::stoul(bytes.substr(start));
    ASSERT_EQ(bytes.compare(table, 7, "xref\n0 "), 0);
    const std::size_t size = std::stoul(bytes.substr(table + 7));
    const std::size_t rows = bytes.find('\n', table + 7) + 1;
    ASSERT_GT(size, 6u);
    for (std::size_t i = 1; i < size; ++i) {
        const std::size_t place = std::stoul(bytes.substr(rows + 20 * i, 10));
        const std::string head = std::to_string(i) + " 0 obj\n";
        EXPECT_EQ(bytes.compare(place, head.size(), head), 0) << i;
    }
}

TEST(PdfWriter, OnlyUsedLayersAreListed) {
    const std::string bytes = pdf_bytes(small_document());
    EXPECT_EQ(count(bytes, "/Type /OCG"), 1u);
    EXPECT_EQ(count(bytes, "/Type /Page "), 2u);
    EXPECT_EQ(count(bytes, "/PrintScaling /None"), 1u);
}

TEST(PdfWriter, PagesBeyondTheLargestSizeHaveLargerUnits) {
    Document document = small_document();
    EXPECT_EQ(count(pdf_bytes(document), "/UserUnit 1 "), 2u);
    document.pages[0].width = 12000; // mm: 34,016 points
    const std::string bytes = pdf_bytes(document);
    EXPECT_EQ(count(bytes, "/UserUnit 3 "), 1u);
    EXPECT_EQ(count(bytes, "/MediaBox [0 0 11338.58267717 "), 1u);
}

TEST(PdfWriter, SameBytesInEveryLocale) {
    const std::string expected = pdf_bytes(small_document());
    const std::string before = std::setlocale(LC_ALL, nullptr);
    for (const char* name : {"de_DE.UTF-8", "C.UTF-8", "C"})
        if (std::setlocale(LC_ALL, name) != nullptr) {
            EXPECT_EQ(pdf_bytes(small_document()), expected) << name;
        }
    std::setlocale(LC_ALL, before.c_str());
}

TEST(PdfWriter, StringsAreEscaped) {
    EXPECT_EQ(PdfObjects::literal("a(b)\\"), "(a\\(b\\)\\\\)");
    EXPECT_EQ(PdfObjects::text("A\xc3\xa4"), "<FEFF004100E4>");
}

TEST(TextMetrics, WidthsAreThoseOfHelvetica) {
    EXPECT_NEAR(text_width("Wi", 10.0), 0.01 * (944 + 222), 1e-12);
    EXPECT_NEAR(text_width("50 mm", 8.0), 0.008 * (2 * 556 + 278 + 2 * 833), 1e-12);
}

TEST(TextMetrics, CharactersThatAFileCannotHoldAreReplaced) {
    EXPECT_EQ(latin1("a\xc3\xa4\xe2\x82\xac\n"), "a\xe4? ");
    EXPECT_EQ(ascii("a\xc3\xa4\xf0\x9f\x90\xb0z"), "a??z");
}

} // namespace
} // namespace devseg::writers
