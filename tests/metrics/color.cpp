#include "item3d/metrics/color.h"

#include "item3d/core/error.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

void expect_lab(const Lab& lab, double l, double a, double b) {
    EXPECT_NEAR(lab.l, l, 0.02);
    EXPECT_NEAR(lab.a, a, 0.02);
    EXPECT_NEAR(lab.b, b, 0.02);
}

// The reference values are those of Bruce Lindbloom's calculator (sRGB, D65).
TEST(Lab, AgreesWithPublishedValues) {
    expect_lab(srgb_to_lab(Vec3(1)), 100, 0, 0);
    expect_lab(srgb_to_lab(Vec3(0)), 0, 0, 0);
    expect_lab(srgb_to_lab(Vec3(1, 0, 0)), 53.2408, 80.0925, 67.2032);
    expect_lab(srgb_to_lab(Vec3(0, 1, 0)), 87.7347, -86.1827, 83.1793);
    expect_lab(srgb_to_lab(Vec3(0, 0, 1)), 32.2970, 79.1875, -107.8602);
    expect_lab(srgb_to_lab(Vec3(0.5f)), 53.3890, 0, 0);
}

TEST(Lab, DifferenceIsAMetric) {
    const Lab red = srgb_to_lab(Vec3(1, 0, 0));
    const Lab green = srgb_to_lab(Vec3(0, 1, 0));
    EXPECT_EQ(color_difference(red, red), 0);
    EXPECT_EQ(color_difference(red, green), color_difference(green, red));
    EXPECT_NEAR(color_difference(srgb_to_lab(Vec3(1)), srgb_to_lab(Vec3(0))), 100, 0.02);
}

TEST(NearestColor, NamesWhatPeopleWouldName) {
    const auto name = [](Vec3 encoded) {
        const Vec3 linear(srgb_to_linear(encoded.x), srgb_to_linear(encoded.y),
                          srgb_to_linear(encoded.z));
        return basic_colors()[nearest_color(linear, basic_colors())].name;
    };
    for (const NamedColor& color : basic_colors())
        EXPECT_EQ(name(color.srgb), color.name);
    EXPECT_EQ(name(Vec3(0.65f, 0.10f, 0.12f)), "red");
    EXPECT_EQ(name(Vec3(0.15f, 0.30f, 0.70f)), "blue");
    EXPECT_EQ(name(Vec3(0.90f, 0.90f, 0.88f)), "white");
    EXPECT_EQ(name(Vec3(0.35f, 0.22f, 0.15f)), "brown");
}

TEST(ParseColor, ReadsNamesHexadecimalsAndNumbers) {
    EXPECT_EQ(parse_color("white"), Vec3(1));
    EXPECT_EQ(parse_color("#000"), Vec3(0));
    EXPECT_EQ(parse_color("#ff8000"), Vec3(1, 128 / 255.0f, 0));
    EXPECT_EQ(parse_color("#f80"), Vec3(1, 136 / 255.0f, 0));
    EXPECT_EQ(parse_color("0.25, 0.5,1"), Vec3(0.25f, 0.5f, 1));
    EXPECT_EQ(parse_color("grey"), parse_color("gray"));
    for (const char* bad : {"", "#", "#12345", "#12345g", "0.1,0.2", "0.1,0.2,0.3,0.4", "2,0,0",
                            "nan,0,0", "-1,0,0", "transparentish"}) {
        EXPECT_THROW(parse_color(bad), InputError) << bad;
    }
}

}  // namespace
}  // namespace item3d
