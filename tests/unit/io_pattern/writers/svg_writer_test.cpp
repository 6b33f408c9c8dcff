#include "writers/svg_writer.h"

#include <algorithm>
#include <clocale>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/pattern/pieces.h"
#include "sheet/sheet_drawing.h"
#include "unit/temporary_folder.h"
#include "writers/file.h"

namespace devseg::writers {
namespace {

namespace fs = std::filesystem;

constexpr double pi = 3.14159265358979323846;

Drawing small_drawing() {
    Drawing drawing;
    drawing.width = 40;
    drawing.height = 30;
    DrawingLayer cut{"cut", "Cut", "#ff0000", {}, {}, {}};
    cut.paths.push_back({"P01-cut",
                         {{{Vec2(10, 10), Vec2(30, 10), Vec2(30, 20.12345), Vec2(10, 20)}, true},
                          {{Vec2(15, 15), Vec2(15, 16), Vec2(16, 15)}, true}}});
    DrawingLayer sew{"sew", "Sew line", "#00a000", {3, 1.5}, {}, {}};
    sew.paths.push_back({"", {{{Vec2(1, 30.0001), Vec2(-0.0001, 2)}, false}}});
    DrawingLayer text{"text", "Text", "#000000", {}, {}, {}};
    text.texts.push_back({Vec2(20, 15), 10, "A<B> & \"\xc3\xa9\""});
    drawing.layers = {cut, {"empty", "Empty", "#0000ff", {}, {}, {}}, sew, text};
    return drawing;
}

pattern::PatternPiece round_piece(const Vec2& centre, double radius, const std::string& name) {
    pattern::PatternPiece piece;
    piece.name = name;
    const int count = 200;
    for (int i = 0; i < count; ++i) {
        const double angle = 2.0 * pi * i / count;
        piece.outer.points.push_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
        piece.box.extend(piece.outer.points.back());
    }
    piece.area = piece.outer.area = 0.5 * count * std::sin(2.0 * pi / count) * radius * radius;
    piece.label_position = centre;
    piece.label_radius = radius;
    return piece;
}

// Two round pieces beside one another; the second has a quarter of the radius.
pattern::Pattern two_pieces(double radius) {
    pattern::Pattern pattern;
    pattern.pieces.push_back(round_piece(Vec2(radius, radius), radius, "P01"));
    pattern.pieces.push_back(round_piece(Vec2(2.5 * radius, radius), 0.25 * radius, "P02"));
    pattern.width = 2.75 * radius;
    pattern.height = 2.0 * radius;
    return pattern;
}

// The points of the path with this id, as they stand in the file.
std::vector<Vec2> points_in_file(const std::string& svg, const std::string& id) {
    const std::size_t start = svg.find("d=\"M ", svg.find("id=\"" + id + '"')) + 3;
    std::string data = svg.substr(start, svg.find('"', start) - start);
    for (char& c : data)
        if (c == 'M' || c == 'L' || c == 'Z' || c == ',')
            c = ' ';
    std::istringstream in(data);
    std::vector<Vec2> points;
    for (double x = 0.0, y = 0.0; in >> x >> y;)
        points.emplace_back(x, y);
    return points;
}

double area_of(const std::vector<Vec2>& points) {
    double twice = 0.0;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        const Vec2 p = points[i] - points[0];
        const Vec2 q = points[i + 1] - points[0];
        twice += p.x() * q.y() - p.y() * q.x();
    }
    return twice / 2.0;
}

TEST(SvgWriter, WritesTheseBytes) {
    const std::string expected =
        R"(<?xml version="1.0" encoding="UTF-8"?>
<svg xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" xmlns:sodipodi="http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd" version="1.1" width="40mm" height="30mm" viewBox="0 0 40 30">
 <sodipodi:namedview inkscape:document-units="mm"/>
 <g id="cut" inkscape:groupmode="layer" inkscape:label="Cut">
  <path id="P01-cut" d="M 10,20 L 30,20 L 30,9.877 L 10,10 Z M 15,15 L 15,14 L 16,15 Z" fill="none" stroke="#ff0000" stroke-width="0.1"/>
 </g>
 <g id="sew" inkscape:groupmode="layer" inkscape:label="Sew line">
  <path d="M 1,0 L 0,28" fill="none" stroke="#00a000" stroke-width="0.1" stroke-dasharray="3 1.5"/>
 </g>
 <g id="text" inkscape:groupmode="layer" inkscape:label="Text">
  <text x="20" y="18.6" font-family="Helvetica, Arial, sans-serif" font-size="10" text-anchor="middle" fill="#000000">A&lt;B&gt; &amp; &quot;é&quot;</text>
 </g>
</svg>
)";
    EXPECT_EQ(svg_bytes(small_drawing()), expected);
}

TEST(SvgWriter, KnowsNoLocale) {
    const std::string before = svg_bytes(small_drawing());
    const std::string kept = std::setlocale(LC_ALL, nullptr);
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "C.UTF-8"})
        if (std::setlocale(LC_ALL, name) != nullptr) {
            EXPECT_EQ(svg_bytes(small_drawing()), before) << name;
        }
    std::setlocale(LC_ALL, kept.c_str());
}

TEST(SvgWriter, PointsThatRoundToOneAreWrittenOnce) {
    Drawing drawing;
    drawing.width = drawing.height = 10;
    DrawingLayer layer{"cut", "Cut", "#ff0000", {}, {}, {}};
    layer.paths.push_back(
        {"p", {{{Vec2(1, 1), Vec2(1.0001, 1), Vec2(2, 1), Vec2(2, 2), Vec2(1, 1.0001)}, true}}});
    drawing.layers.push_back(layer);
    EXPECT_NE(svg_bytes(drawing).find("d=\"M 1,9 L 2,9 L 2,8 Z\""), std::string::npos);
}

TEST(SvgWriter, SavesTheBytesAndReplacesAnOlderFile) {
    const TemporaryFolder folder;
    const std::string path = folder.file("n\xc3\xa4me with space.svg");
    for (int i = 0; i < 2; ++i) {
        save_file(path, svg_bytes(small_drawing()));
        EXPECT_EQ(read_bytes(path), svg_bytes(small_drawing()));
        EXPECT_EQ(folder.count(), 1);
    }
}

TEST(SvgWriter, LeavesNothingAfterAFailure) {
    const TemporaryFolder folder;
    EXPECT_THROW(save_file(folder.file("missing/x.svg"), "x"), FileError);
    EXPECT_EQ(folder.count(), 0);
    fs::create_directory(folder.file("folder.svg"));
    EXPECT_THROW(save_file(folder.file("folder.svg"), "x"), FileError);
    EXPECT_EQ(folder.count(), 1);

    // Root writes everywhere: this part has something to test for other users only.
    const std::string closed = folder.file("closed");
    fs::create_directory(closed);
    fs::permissions(closed, fs::perms::owner_read | fs::perms::owner_exec);
    if (!std::ofstream(closed + "/probe")) {
        EXPECT_THROW(save_file(closed + "/x.svg", "x"), FileError);
        EXPECT_TRUE(fs::is_empty(closed));
    }
    fs::permissions(closed, fs::perms::owner_all);
}

Drawing drawn(const pattern::Pattern& pattern, const sheet::ExportOptions& options = {}) {
    Progress progress;
    return sheet::draw_sheets(sheet::lay_out_pattern(pattern, options, progress), options);
}

TEST(PatternDrawing, OutlinesHoldTheAreaAtAnySize) {
    for (const double radius : {1e-9, 1e-3, 0.05, 2.0, 90.0, 1e5, 1e9}) {
        const pattern::Pattern pattern = two_pieces(radius);
        const Drawing drawing = drawn(pattern);
        const std::string svg = svg_bytes(drawing);
        for (const pattern::PatternPiece& piece : pattern.pieces) {
            const double area = area_of(points_in_file(svg, piece.name + "-cut"));
            // y points down in the file: counterclockwise on the screen is negative here.
            EXPECT_NEAR(-area / piece.area, 1.0, 5e-4) << radius << ' ' << piece.name;
        }
        EXPECT_EQ(drawing.decimals == 3, radius > 10.0) << radius;
    }
}

TEST(PatternDrawing, CheckSquareIsTrueAndClearOfThePieces) {
    for (const double radius : {0.05, 20.0, 300.0}) {
        const pattern::Pattern pattern = two_pieces(radius);
        const Drawing drawing = drawn(pattern);
        const std::string svg = svg_bytes(drawing);
        const std::vector<Vec2> square = points_in_file(svg, "check-square");
        ASSERT_EQ(square.size(), 4u);
        EXPECT_EQ(std::abs(area_of(square)), 2500.0);
        Eigen::AlignedBox2d box;
        for (const Vec2& p : square)
            box.extend(p);
        const std::vector<Vec2> frame = points_in_file(svg, "frame");
        Eigen::AlignedBox2d sheet;
        for (const Vec2& p : frame)
            sheet.extend(p);
        EXPECT_EQ(sheet.min(), Vec2(0, 0));
        EXPECT_EQ(sheet.max(), Vec2(drawing.width, drawing.height));
        EXPECT_TRUE(sheet.contains(box));
        for (const pattern::PatternPiece& piece : pattern.pieces)
            for (const Vec2& p : points_in_file(svg, piece.name + "-cut")) {
                EXPECT_GT(box.exteriorDistance(p), 9.9);
                EXPECT_GT(std::min((p - sheet.min()).minCoeff(), (sheet.max() - p).minCoeff()),
                          9.9);
            }
    }
}

TEST(PatternDrawing, LabelsFitIntoTheirPieces) {
    const pattern::Pattern pattern = two_pieces(25.0);
    const Drawing drawing = drawn(pattern);
    const DrawingLayer& layer = drawing.layers.back();
    ASSERT_EQ(layer.id, "text");
    ASSERT_EQ(layer.texts.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        const double half_width = 0.5 * 3 * 0.6 * layer.texts[i].size;
        EXPECT_LT(std::hypot(half_width, 0.5 * layer.texts[i].size),
                  pattern.pieces[i].label_radius);
        EXPECT_GE(layer.texts[i].size, 2.5);
    }
    EXPECT_LE(drawn(two_pieces(500.0)).layers.back().texts[0].size, 8.0);

    sheet::ExportOptions silent;
    silent.labels = false;
    const std::string svg = svg_bytes(drawn(pattern, silent));
    EXPECT_EQ(svg.find("id=\"text\""), std::string::npos);
    EXPECT_NE(svg.find(">50 mm<"), std::string::npos);
}

} // namespace
} // namespace devseg::writers
