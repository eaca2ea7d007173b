// Tests of the directions in sentences, and of lights from given directions.
#include "item3d/lighting/words.h"

#include "item3d/lighting/adjust.h"
#include "item3d/lighting/environment.h"

#include <gtest/gtest.h>

#include <cmath>

namespace item3d {
namespace {

struct Phrase {
    const char* text;
    float azimuth;
    float elevation;
    const char* rest = "";
};

// The camera is at azimuth 180, the south, and looks north.
const std::vector<Phrase> phrases = {
    {"lit from the left", 270, 25},
    {"from the right side", 90, 25},
    {"from behind", 0, 25},
    {"from behind the camera", 180, 18},
    {"from the camera", 180, 18},
    {"light from above", 0, 90},
    {"lit from below", 0, -90},
    {"from the front right", 135, 25},
    {"from above left", 270, 45},
    {"from the back left and below", 315, -35},
    {"sun low in the east", 90, 8},
    {"low sun in the north-west", 315, 8},
    {"a high sun in the southeast", 135, 60},
    {"from 2 o'clock", 60, 25},
    {"Ten o'clock, high", 300, 60},
    {"front left", 225, 25},
    {"from camera left, 40 degrees up", 270, 40},
    {"a golden evening, lit from the left", 270, 25, "a golden evening, lit"},
    {"low red light from the right in winter", 90, 25, "low red light in winter"},
    {"backlit, foggy", 0, 25, "foggy"},
    {"from the upper left", 270, 45},
};

float angle_between(Vec3 a, Vec3 b) {
    return std::acos(std::min(1.0f, glm::dot(a, b))) * 180 / pi;
}

TEST(LightWords, SayDirections) {
    for (const Phrase& phrase : phrases) {
        const LightWords words = parse_light_words(phrase.text, 180);
        ASSERT_TRUE(words.from) << phrase.text;
        const Vec3 expected = to_direction({phrase.azimuth, phrase.elevation});
        EXPECT_LT(angle_between(to_direction(*words.from), expected), 0.1f)
            << phrase.text << ": " << words.from->azimuth << ", " << words.from->elevation;
        EXPECT_EQ(words.rest, phrase.rest) << phrase.text;
    }
}

TEST(LightWords, ViewerWordsFollowTheCameraAndCompassWordsDoNot) {
    EXPECT_NEAR(parse_light_words("from the left", 145).from->azimuth, 235, 0.01);
    EXPECT_NEAR(parse_light_words("from 6 o'clock", 145).from->azimuth, 145, 0.01);
    EXPECT_NEAR(parse_light_words("from the west", 145).from->azimuth, 270, 0.01);
}

TEST(LightWords, SayNothingWhereThereIsNoDirection) {
    for (const char* text : {"", "a left glove in high spirits", "warm candle light",
                             "at 14 o'clock", "the top of the class was bright",
                             "from the left and from the right", "high", "1000000000000 o'clock"}) {
        const LightWords words = parse_light_words(text, 180);
        EXPECT_FALSE(words.from) << text;
    }
    EXPECT_EQ(parse_light_words("a left glove in high spirits", 180).rest,
              "a left glove in high spirits");
    EXPECT_EQ(parse_light_words("candle light", 180).rest, "candle light");
}

TEST(SkyAngles, GoThereAndBack) {
    EXPECT_LT(angle_between(to_direction({0, 0}), Vec3(0, 0, -1)), 0.1f);
    EXPECT_LT(angle_between(to_direction({90, 0}), Vec3(1, 0, 0)), 0.1f);
    for (const float azimuth : {0.0f, 100.0f, 200.0f, 359.0f}) {
        const SkyAngles back = to_sky_angles(to_direction({azimuth, -40}));
        EXPECT_NEAR(back.azimuth, azimuth, 1e-3);
        EXPECT_NEAR(back.elevation, -40, 1e-3);
    }
}

// Tests the direction of the brightest lobe after a sun was placed. The studio has no sun, so one
// is added; the sun of noon is moved.
TEST(PlaceSun, StandsWhereTheWordsSay) {
    for (const char* preset : {"studio", "noon"}) {
        const Image light = make_light_preset(preset, 64);
        for (const Phrase& phrase : phrases) {
            SunSetting setting;
            setting.from = *parse_light_words(phrase.text, 145).from;
            const Image lit = place_sun(light, setting);
            EXPECT_LT(angle_between(brightest_lobe(lit).direction, to_direction(setting.from)), 2)
                << preset << ", " << phrase.text;
        }
    }
}

TEST(PlaceSun, MovesTheOneThatIsThereAndKeepsTheBrightestSurface) {
    const Image noon = make_light_preset("noon", 64);
    const Vec3 before = brightest_lobe(noon).direction;
    SunSetting setting;
    setting.from = {300, 30};
    const Image moved = place_sun(noon, setting);
    const auto at = [](const Image& light, Vec3 direction) {
        const Vec2 uv = equirectangular_uv(direction);
        return light.at(static_cast<int>(uv.x * light.width), static_cast<int>(uv.y * light.height),
                        1);
    };
    EXPECT_LT(at(moved, before), 0.05f * at(noon, before));
    EXPECT_NEAR(peak_irradiance_over_pi(moved), peak_irradiance_over_pi(noon), 1e-3);
    // The sun's share of the light is unchanged.
    EXPECT_NEAR(brightest_lobe(moved).share, brightest_lobe(noon).share, 0.05);
}

TEST(PlaceSun, HasTheStrengthThatWasAskedFor) {
    const Image even(128, 64, 3, 0.5f);
    for (const float width : {0.53f, 6.0f}) {
        SunSetting setting;
        setting.strength = 3;
        setting.width = width;
        const Image lit = place_sun(even, setting);
        const double rest = lit.at(0, 0, 1), all = mean_radiance(lit).y;
        // The sun gives an irradiance of 3 pi L on a plane that faces it. The rest of the light has
        // the radiance L everywhere; its integral over the sphere is 4 pi L.
        EXPECT_NEAR(1 - rest / all, 3.0 / 7.0, 1e-4) << width;
    }
}

}  // namespace
}  // namespace item3d
