#include "writers/dxf_writer.h"

#include <algorithm>
#include <clocale>
#include <sstream>
#include <utility>

#include <gtest/gtest.h>

namespace devseg::writers {
namespace {

using Groups = std::vector<std::pair<int, std::string>>;

Groups parse(const std::string& bytes) {
    Groups groups;
    std::istringstream lines(bytes);
    std::string code;
    std::string value;
    while (std::getline(lines, code) && std::getline(lines, value))
        groups.emplace_back(std::stoi(code), value.substr(0, value.find('\r')));
    return groups;
}

std::vector<std::string> values(const Groups& groups, int code) {
    std::vector<std::string> found;
    for (const auto& [number, value] : groups)
        if (number == code)
            found.push_back(value);
    return found;
}

Drawing small_drawing() {
    Drawing drawing;
    drawing.width = 40;
    drawing.height = 30;
    DrawingLayer cut{"cut", "Cut", "#ff0000", {}, {}, {}};
    cut.paths.push_back(
        {"P01-cut",
         {{{Vec2(10, 10), Vec2(30, 10), Vec2(30, 10.0001), Vec2(30, 20), Vec2(10, 10)}, true},
          {{Vec2(1, 1), Vec2(1.0001, 1)}, false}}});
    DrawingLayer sew{"sew", "Sew line", "#00a000", {3, 1.5}, {}, {}};
    sew.paths.push_back({"", {{{Vec2(1, 2), Vec2(3, 4)}, false}}});
    DrawingLayer text{"text", "Text", "#000000", {}, {}, {}};
    text.texts.push_back({Vec2(20, 15), 10, "P\xc3\xa4", 0.5});
    drawing.layers = {cut, {"empty", "Empty", "#0000ff", {}, {}, {}}, sew, text};
    return drawing;
}

// Points that coincide on the file's grid are one, and lines without length are none.
TEST(DxfWriter, EveryVertexIsANewPoint) {
    const std::vector<std::string> kinds = values(parse(dxf_bytes(small_drawing())), 0);
    EXPECT_EQ(std::count(kinds.begin(), kinds.end(), "POLYLINE"), 2);
    EXPECT_EQ(std::count(kinds.begin(), kinds.end(), "VERTEX"), 3 + 2);
    EXPECT_EQ(std::count(kinds.begin(), kinds.end(), "SEQEND"), 2);
    EXPECT_EQ(kinds.back(), "EOF");
}

TEST(DxfWriter, LayersHaveTheirColours) {
    const Groups groups = parse(dxf_bytes(small_drawing()));
    EXPECT_EQ(values(groups, 62), (std::vector<std::string>{"1", "3", "7"}));
    const std::vector<std::string> names = values(groups, 2);
    EXPECT_EQ(std::count(names.begin(), names.end(), "SEW_LINE"), 1);
    EXPECT_EQ(std::count(names.begin(), names.end(), "EMPTY"), 0);
}

TEST(DxfWriter, SevenBits) {
    const std::string bytes = dxf_bytes(small_drawing());
    EXPECT_TRUE(std::all_of(bytes.begin(), bytes.end(),
                            [](char c) { return static_cast<unsigned char>(c) < 0x80; }));
    EXPECT_NE(bytes.find("P?\r\n"), std::string::npos);
}

TEST(DxfWriter, SameBytesInEveryLocale) {
    const std::string expected = dxf_bytes(small_drawing());
    const std::string before = std::setlocale(LC_ALL, nullptr);
    for (const char* name : {"de_DE.UTF-8", "C.UTF-8"})
        if (std::setlocale(LC_ALL, name) != nullptr) {
            EXPECT_EQ(dxf_bytes(small_drawing()), expected) << name;
        }
    std::setlocale(LC_ALL, before.c_str());
}

TEST(DxfWriter, CurvesAreSplinesOfRelease2000) {
    Drawing drawing = small_drawing();
    DrawingPolyline& ring = drawing.layers[0].paths[0].parts[0];
    const Vec2 a(10, 10);
    const Vec2 b(30, 10);
    ring.curves = {{{a, Vec2(15, 0), Vec2(25, 0), b}, false}, {{b, b, a, a}, true}};
    const Groups groups = parse(dxf_bytes(drawing));
    const auto has = [&](int code, const char* value) {
        return std::find(groups.begin(), groups.end(), std::pair(code, std::string(value))) !=
               groups.end();
    };
    EXPECT_TRUE(has(1, "AC1015"));
    EXPECT_TRUE(has(0, "SPLINE"));
    EXPECT_TRUE(has(0, "LWPOLYLINE")) << "the sew line";
    EXPECT_TRUE(has(72, "11")) << "knots of two curves of degree 3";
    EXPECT_TRUE(has(73, "7"));
    // No handle is used twice, and the next one is free.
    std::vector<std::string> handles = values(groups, 5);
    const std::string seed = handles.front();
    std::sort(handles.begin(), handles.end());
    EXPECT_EQ(std::adjacent_find(handles.begin(), handles.end()), handles.end());
    EXPECT_EQ(std::count(handles.begin(), handles.end(), seed), 1);
}

} // namespace
} // namespace devseg::writers
