// Tests of cube maps and light probes that are made from a function of direction.
#include "item3d/lighting/layout.h"

#include "item3d/core/error.h"
#include "item3d/lighting/adjust.h"
#include "item3d/lighting/environment.h"
#include "item3d/lighting/presets/sky_hour.h"

#include <gtest/gtest.h>

#include <cmath>

namespace item3d {
namespace {

/// Returns a different radiance in every direction.
Vec3 smooth_radiance(Vec3 d) {
    return Vec3(1.5f + d.x, 1.5f + d.y, 1.5f + d.z);
}

/// Returns the direction of pixel (x, y) of a layout. Unlike the reader, it follows the faces in
/// the unfolded drawing.
Vec3 paper_direction(const std::string& layout, int x, int y, int side) {
    const auto local = [&](int i) { return 2 * (static_cast<float>(i % side) + 0.5f) / side - 1; };
    const float s = local(x);
    const float t = local(y);
    const int column = x / side;
    const int row = y / side;
    char face = 'f';
    if (layout == "row") face = "rludfb"[column];
    if (layout == "column") face = "rludfb"[row];
    if (layout == "wide") face = row == 0 ? 'u' : row == 2 ? 'd' : "lfrb"[column];
    if (layout == "tall") face = row == 1 ? "lfr"[column] : row == 0 ? 'u' : row == 2 ? 'd' : 'B';
    Vec3 d(s, -t, -1);                      // front
    if (face == 'r') d = Vec3(1, -t, s);    // its left edge meets the front
    if (face == 'l') d = Vec3(-1, -t, -s);  // its right edge meets the front
    if (face == 'u') d = Vec3(s, 1, -t);    // its lower edge meets the front
    if (face == 'd') d = Vec3(s, -1, t);    // its upper edge meets the front
    if (face == 'b') d = Vec3(-s, -t, 1);   // its left edge meets the right face
    if (face == 'B') d = Vec3(s, t, 1);     // its upper edge meets the lower face
    return glm::normalize(d);
}

void expect_smooth(const Image& light, float tolerance, const std::string& what) {
    ASSERT_EQ(light.width, 2 * light.height) << what;
    float worst = 0;
    for (int y = 0; y < light.height; ++y) {
        for (int x = 0; x < light.width; ++x) {
            const Vec3 expected = smooth_radiance(
                equirectangular_direction((x + 0.5f) / light.width, (y + 0.5f) / light.height));
            for (int c = 0; c < 3; ++c)
                worst = std::max(worst, std::abs(light.at(x, y, c) - expected[c]));
        }
    }
    EXPECT_LT(worst, tolerance) << what;
}

TEST(LightLayout, CubesAreReadByTheShapeOfTheImage) {
    constexpr int side = 16;
    struct Shape {
        const char* name;
        int columns;
        int rows;
    };
    for (const Shape& shape :
         {Shape{"wide", 4, 3}, Shape{"tall", 3, 4}, Shape{"row", 6, 1}, Shape{"column", 1, 6}}) {
        Image image(shape.columns * side, shape.rows * side, 3);
        for (int y = 0; y < image.height; ++y) {
            for (int x = 0; x < image.width; ++x) {
                const Vec3 value = smooth_radiance(paper_direction(shape.name, x, y, side));
                for (int c = 0; c < 3; ++c)
                    image.at(x, y, c) = value[c];
            }
        }
        const Image light = to_equirectangular(image, LightLayout::automatic, "test");
        EXPECT_EQ(light.height, 2 * side);
        // At the faces' edges, values are off by half a texel.
        expect_smooth(light, 0.08f, shape.name);
    }
}

TEST(LightLayout, ProbesAreSquare) {
    constexpr int side = 128;
    Image probe(side, side, 3);
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            // The distance from the middle is proportional to the angle from the front (Debevec
            // 1998).
            const float u = 2 * (x + 0.5f) / side - 1, v = 1 - 2 * (y + 0.5f) / side;
            const float angle = pi * std::min(1.0f, std::hypot(u, v)), turn = std::atan2(v, u);
            const Vec3 value =
                smooth_radiance(Vec3(std::sin(angle) * std::cos(turn),
                                     std::sin(angle) * std::sin(turn), -std::cos(angle)));
            for (int c = 0; c < 3; ++c)
                probe.at(x, y, c) = value[c];
        }
    }
    expect_smooth(to_equirectangular(probe, LightLayout::automatic, "test"), 0.08f, "probe");
}

TEST(LightLayout, SaysWhatDoesNotFit) {
    const Image odd(70, 30, 3, 1.0f);
    EXPECT_THROW(to_equirectangular(odd, LightLayout::automatic, "odd"), InputError);
    EXPECT_THROW(to_equirectangular(odd, LightLayout::cross, "odd"), InputError);
    EXPECT_THROW(to_equirectangular(odd, LightLayout::strip, "odd"), InputError);
    EXPECT_THROW(to_equirectangular(odd, LightLayout::angular, "odd"), InputError);
    EXPECT_EQ(to_equirectangular(odd, LightLayout::equirectangular, "odd").width, 70);
    EXPECT_THROW(parse_light_layout("dome"), InputError);
}

TEST(TiltLight, LiftsTheNorth) {
    const Image light = light_from(32, smooth_radiance);
    const Image tilted = tilt_light(light, 90);
    // The north moves overhead, and what was overhead moves to the south.
    const Vec3 north = smooth_radiance(Vec3(0, 0, -1)), above = smooth_radiance(Vec3(0, 1, 0));
    const Vec3 now_above = look_up(tilted, Vec3(0, 1, 0)), south = look_up(tilted, Vec3(0, 0, 1));
    EXPECT_LT(glm::distance(now_above, north), 0.1f);
    EXPECT_LT(glm::distance(south, above), 0.1f);
}

TEST(TintLight, KeepsLuminanceOfWhite) {
    const Image tinted = tint_light(Image(8, 4, 3, 0.5f), Vec3(0.9f, 0.4f, 0.1f));
    EXPECT_NEAR(luminance(mean_radiance(tinted)), 0.5, 1e-5);
    EXPECT_GT(tinted.at(0, 0, 0), 2 * tinted.at(0, 0, 1));
    EXPECT_THROW(tint_light(tinted, Vec3(0)), InputError);
}

TEST(DescribeLight, FindsALampAndItsColour) {
    Image light(64, 32, 3, 0.01f);
    for (int x = 47; x <= 48; ++x) {
        for (int y = 15; y <= 16; ++y)
            light.at(x, y, 0) = light.at(x, y, 1) = light.at(x, y, 2) = 20;
    }
    const LightDescription described = describe_light(light);
    EXPECT_NEAR(to_sky_angles(described.lobe.direction).azimuth, 90, 0.1);
    EXPECT_NEAR(to_sky_angles(described.dominant_direction).azimuth, 90, 0.1);
    EXPECT_NEAR(described.lobe.solid_angle, 4 * std::pow(2 * M_PI / 64, 2), 4e-4);
    EXPECT_TRUE(described.lobe.is_sun() == (described.lobe.radius() < 5 * M_PI / 180));
    EXPECT_NEAR(*described.color_temperature, 6504, 40);  // the white of sRGB is D65
    EXPECT_NEAR(*described.dynamic_range, std::log2(2000.0), 1e-3);
    const LightDescription black = describe_light(Image(8, 4, 3, 0.0f));
    EXPECT_EQ(black.lobe.share, 0);
    EXPECT_FALSE(black.color_temperature || black.dynamic_range);
}

TEST(SkyAt, FollowsTheSunThroughTheDay) {
    float brightness = 0;
    for (const float hour : {7.0f, 9.0f, 12.0f, 16.0f}) {
        const Image sky = make_sky_at(hour, 32);
        const Vec3 lobe = brightest_lobe(sky).direction;
        EXPECT_GT(glm::dot(lobe, sun_direction_at(hour)), std::cos(4 * pi / 180)) << hour;
        brightness = peak_irradiance_over_pi(sky);
        EXPECT_GT(brightness, 0.7f) << hour;
    }
    const float night = peak_irradiance_over_pi(make_sky_at(0, 32));
    EXPECT_NEAR(night, 0.15f, 0.01f);
    // Irradiance has no jump at dusk.
    float last = peak_irradiance_over_pi(make_sky_at(17.4f, 32));
    for (float hour = 17.6f; hour < 18.7f; hour += 0.2f) {
        const float now = peak_irradiance_over_pi(make_sky_at(hour, 32));
        EXPECT_LT(std::abs(now - last), 0.2f) << hour;
        last = now;
    }
    EXPECT_THROW(make_sky_at(25, 32), InputError);
}

}  // namespace
}  // namespace item3d
