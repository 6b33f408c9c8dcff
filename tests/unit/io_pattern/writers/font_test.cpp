// The fonts that are part of the library.
#include "writers/font.h"

#include <gtest/gtest.h>

#include "devseg/plane/plane.h"
#include "writers/text.h"

namespace devseg::writers {
namespace {

Eigen::AlignedBox2d box_of(const std::vector<DrawingPolyline>& lines) {
    Eigen::AlignedBox2d box;
    for (const DrawingPolyline& line : lines)
        for (const DrawingCurve& curve : line.curves)
            for (const Vec2& p : curve.control)
                box.extend(p);
    return box;
}

TEST(Font, KnowsTheShapesOfLetters) {
    const Font& font = built_in_fonts().front();
    EXPECT_EQ(font.outline(font.glyph('o')).size(), 2U) << "a ring";
    EXPECT_EQ(font.outline(font.glyph('B')).size(), 3U);
    EXPECT_TRUE(font.outline(font.glyph(' ')).empty());
    const Eigen::AlignedBox2d capital = box_of(font.outline(font.glyph('H')));
    EXPECT_NEAR(capital.min().y(), 0.0, 1e-9) << "stands on the line";
    EXPECT_NEAR(capital.max().y(), 0.73, 0.01);
    EXPECT_GT(font.advance(font.glyph('m')), 1.5 * font.advance(font.glyph('i')));
    // Made of two glyphs: the dots lie above the letter.
    const auto umlaut = font.outline(font.glyph(0xe4));
    EXPECT_EQ(umlaut.size(), font.outline(font.glyph('a')).size() + 2);
    EXPECT_GT(box_of(umlaut).max().y(), box_of(font.outline(font.glyph('a'))).max().y() + 0.1);
    for (const auto& line : umlaut)
        for (std::size_t i = 0; i < line.curves.size(); ++i)
            EXPECT_EQ(line.curves[i].control[3],
                      line.curves[(i + 1) % line.curves.size()].control[0]);
}

TEST(Font, KnowsOtherScriptsAndSaysWhatItLacks) {
    EXPECT_FALSE(needs_font("b\xc3\xa4r"));
    EXPECT_TRUE(needs_font("\xd0\x9c\xd0\xb8")); // Cyrillic
    EXPECT_EQ(missing_glyphs("\xd0\x9c\xd0\xb8 \xce\xa9"), 0);
    for (const char* name : {"a\xe7\x86\x8a", "\xe3\x81\x8f\xe3\x81\xbe", // Chinese, Japanese
                             "\xea\xb3\xb0"})                             // Korean
        EXPECT_EQ(missing_glyphs(name), 0) << name;
    EXPECT_EQ(missing_glyphs("a\xf0\x9f\x90\xbb"), 1) << "a picture of a bear";
}

TEST(Font, IsTheFirstThatHasTheCharacter) {
    EXPECT_EQ(glyph_of('a').font, 0U);
    const Glyph bear = glyph_of(0x718a);
    ASSERT_EQ(bear.font, 1U);
    const Font& font = built_in_fonts()[bear.font];
    EXPECT_NEAR(advance(bear), 1.0, 0.01) << "as wide as high";
    const Eigen::AlignedBox2d box = box_of(font.outline(bear.number));
    EXPECT_GT(box.sizes().minCoeff(), 0.8);
    EXPECT_TRUE(font.box().contains(box));
}

TEST(Font, SubsetsHaveTheSameGlyphsAndAreSmall) {
    const Font& font = built_in_fonts().front();
    const std::string one = font.subset({font.glyph(0x416)});
    const std::string more = font.subset({font.glyph(0x416), font.glyph(0xe4)});
    EXPECT_LT(one.size(), 100000U);
    EXPECT_GT(more.size(), one.size());
    EXPECT_EQ(one.substr(0, 4), std::string("\0\1\0\0", 4));
}

TEST(OutlinedTexts, TakeTheRoomOfTheTexts) {
    Drawing drawing;
    DrawingLayer layer{"text", "Text", "#000000", {}, {}, {}};
    layer.texts.push_back({Vec2(50.0, 20.0), 10.0, "HOH", 0.0, TextAnchor::middle, "P01"});
    drawing.layers = {layer};
    const Drawing outlined = with_outlined_texts(drawing);
    ASSERT_TRUE(outlined.layers[0].texts.empty());
    ASSERT_EQ(outlined.layers[0].paths.size(), 1U);
    EXPECT_EQ(outlined.layers[0].paths[0].owner, "P01");
    EXPECT_EQ(outlined.layers[0].paths[0].parts.size(), 4U);
    const Eigen::AlignedBox2d box = box_of(outlined.layers[0].paths[0].parts);
    EXPECT_NEAR(box.center().x(), 50.0, 0.1);
    EXPECT_NEAR(box.center().y(), 20.0, 0.1);
    EXPECT_LT(box.sizes().x(), text_width("HOH", 10.0));
    EXPECT_GT(box.sizes().x(), 0.8 * text_width("HOH", 10.0));
}

} // namespace
} // namespace devseg::writers
