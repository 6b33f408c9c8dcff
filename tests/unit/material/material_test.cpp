#include "devseg/material/material.h"

#include <gtest/gtest.h>

#include "devseg/base/errors.h"
#include "devseg/base/numbers.h"

namespace devseg::material {
namespace {

TEST(Materials, AreWithinTheirRanges) {
    ASSERT_EQ(material_table().size(), 12u);
    for (const Material& m : material_table()) {
        EXPECT_FALSE(m.source.empty()) << m.name;
        for (const MaterialValue& value : material_values())
            if (value.number != nullptr) {
                EXPECT_GE(m.*(value.number), value.least) << m.name << ' ' << value.key;
                EXPECT_LE(m.*(value.number), value.most) << m.name << ' ' << value.key;
            }
    }
}

TEST(Materials, LimitsGoFromWarpOverBiasToWeft) {
    Material m;
    m.warp = 0.02;
    m.weft = 0.04;
    m.bias = 0.12;
    EXPECT_NEAR(m.stretch_limit(0.0), 0.02, 1e-12);
    EXPECT_NEAR(m.stretch_limit(0.5 * pi), 0.04, 1e-12);
    EXPECT_NEAR(m.stretch_limit(0.25 * pi), 0.12, 1e-12);
    EXPECT_NEAR(m.stretch_limit(-0.25 * pi), 0.12, 1e-12);
    EXPECT_NEAR(m.stretch_limit(0.3), m.stretch_limit(0.3 + pi), 1e-12);
    EXPECT_EQ(m.least_limit(), 0.02);
}

TEST(Materials, TakeValuesOfTheirOwn) {
    const Material m = read_material(" fleece , warp = 0.2,nap=1");
    EXPECT_EQ(m.warp, 0.2);
    EXPECT_TRUE(m.has_nap);
    EXPECT_EQ(m.weft, read_material("fleece").weft);
}

TEST(Materials, RefuseWhatTheyDoNotKnow) {
    const auto message = [](const std::string& text) -> std::string {
        try {
            read_material(text);
        } catch (const InvalidParameter& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(message("silk").find("expected one of cotton, canvas"), std::string::npos);
    EXPECT_NE(message("cotton, warp=-0.1").find("warp from 0 to 2, found '-0.1'"),
              std::string::npos);
    EXPECT_NE(message("cotton, nap=0.5").find("nap from 0 or 1"), std::string::npos);
    EXPECT_NE(message("cotton, warp=nan").find("found 'nan'"), std::string::npos);
    EXPECT_NE(message("cotton, wrap=0.1").find("found 'wrap=0.1'"), std::string::npos);
    EXPECT_NE(message("cotton, ").find("found ''"), std::string::npos);
    EXPECT_NE(message("").find("found ''"), std::string::npos);
}

} // namespace
} // namespace devseg::material
