#include "item3d/lighting/environment.h"

#include "item3d/core/error.h"
#include "item3d/io/load.h"
#include "item3d/io/load_light.h"
#include "item3d/io/save.h"
#include "item3d/lighting/presets/sky_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

namespace item3d {
namespace {

float mean(Vec3 v) {
    return (v.x + v.y + v.z) / 3;
}

float largest_irradiance(const Image& light) {
    float largest = 0;
    for (int i = 0; i < 300; ++i) {
        const float y = 1 - (2 * i + 1) / 300.0f;
        const float radius = std::sqrt(1 - y * y);
        const Vec3 normal(radius * std::cos(2.4f * i), y, radius * std::sin(2.4f * i));
        largest = std::max(largest, mean(irradiance_over_pi(light, normal)));
    }
    return largest;
}

Vec3 brightest_direction(const Image& light) {
    const auto peak = std::max_element(light.pixels.begin(), light.pixels.end());
    const auto index = (peak - light.pixels.begin()) / 3;
    return equirectangular_direction((index % light.width + 0.5f) / light.width,
                                     (index / light.width + 0.5f) / light.height);
}

TEST(Equirectangular, CentreLooksAlongMinusZAndRightQuarterAlongX) {
    const auto near = [](Vec3 a, Vec3 b) { return glm::distance(a, b) < 1e-5f; };
    EXPECT_TRUE(near(equirectangular_direction(0.5f, 0.5f), Vec3(0, 0, -1)));
    EXPECT_TRUE(near(equirectangular_direction(0.75f, 0.5f), Vec3(1, 0, 0)));
    EXPECT_TRUE(near(equirectangular_direction(0.25f, 0.5f), Vec3(-1, 0, 0)));
    EXPECT_TRUE(near(equirectangular_direction(0.0f, 0.5f), Vec3(0, 0, 1)));
    EXPECT_TRUE(near(equirectangular_direction(0.3f, 0.0f), Vec3(0, 1, 0)));
    for (const float u : {0.03f, 0.4f, 0.8f}) {
        for (const float v : {0.1f, 0.5f, 0.93f}) {
            const Vec2 back = equirectangular_uv(equirectangular_direction(u, v));
            EXPECT_NEAR(back.x, u, 1e-5);
            EXPECT_NEAR(back.y, v, 1e-5);
        }
    }
}

TEST(Equirectangular, TexelsCoverTheSphere) {
    double sum = 0;
    for (int y = 0; y < 32; ++y)
        sum += 64 * texel_solid_angle(y, 32);
    EXPECT_NEAR(sum, 4 * M_PI, 1e-9);
    // In a white furnace, every normal receives radiance 1.
    EXPECT_NEAR(irradiance_over_pi(Image(128, 64, 3, 1.0f), Vec3(0.6f, 0, 0.8f)).y, 1, 1e-3);
}

TEST(LightPreset, EachHasItsPeakIsFiniteAndDeterministic) {
    const std::map<std::string, float> dim{{"sunset", 0.7f}, {"night", 0.15f}};
    for (const LightPreset& preset : light_presets()) {
        const std::string& name = preset.name;
        const float peak = dim.contains(name) ? dim.at(name) : 1.0f;
        EXPECT_EQ(preset.peak, peak) << name;
        const Image light = make_light_preset(name, 64);
        ASSERT_EQ(light.width, 128);
        ASSERT_EQ(light.channels, 3);
        for (const float value : light.pixels) {
            ASSERT_TRUE(std::isfinite(value) && value >= 0) << name;
        }
        EXPECT_NEAR(largest_irradiance(light), peak, 0.03f * peak) << name;
        EXPECT_EQ(light.pixels, make_light_preset(name, 64).pixels) << name;
    }
    EXPECT_THROW(make_light_preset("disco"), InputError);
}

TEST(LightPreset, LightDoesNotDependOnResolution) {
    for (const std::string& name : light_preset_names()) {
        const Image coarse = make_light_preset(name, 32);
        const Image fine = make_light_preset(name, 128);
        for (const Vec3 normal : {Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(0, -1, 0)}) {
            const float a = mean(irradiance_over_pi(coarse, normal));
            const float b = mean(irradiance_over_pi(fine, normal));
            // The number of stars is the same at any size of the image, so the night may differ a
            // little.
            EXPECT_NEAR(a, b, 0.05f * b + 0.004f) << name << " " << normal.x << " " << normal.y;
        }
    }
}

TEST(LightPreset, LooksLikeItsName) {
    const Image noon = make_light_preset("noon", 64);
    const Image sunset = make_light_preset("sunset", 64);
    EXPECT_GT(brightest_direction(noon).y, 0.7f);
    EXPECT_LT(brightest_direction(sunset).y, 0.2f);
    EXPECT_GT(brightest_direction(sunset).y, 0.0f);
    const Vec3 red_sun = irradiance_over_pi(sunset, brightest_direction(sunset));
    EXPECT_GT(red_sun.x, 2 * red_sun.z);
    // Away from the sun, the sky at noon is blue.
    const Vec2 away = equirectangular_uv(glm::normalize(Vec3(-0.5f, 0.7f, -0.5f)));
    const int x = static_cast<int>(away.x * noon.width);
    const int y = static_cast<int>(away.y * noon.height);
    EXPECT_GT(noon.at(x, y, 2), 1.5f * noon.at(x, y, 0));

    const Image overcast = make_light_preset("overcast", 64);
    double zenith = 0;
    double horizon = 0;
    for (int i = 0; i < overcast.width; ++i) {
        zenith += overcast.at(i, 0, 1);
        horizon += overcast.at(i, 31, 1);
    }
    EXPECT_NEAR(zenith / horizon, 3, 0.6);

    // Metal needs bright and dark areas, so most of the studio is far below its brightest box.
    const Image studio = make_light_preset("studio", 64);
    const float peak = *std::max_element(studio.pixels.begin(), studio.pixels.end());
    const auto dark = std::count_if(studio.pixels.begin(), studio.pixels.end(),
                                    [&](float value) { return value < peak / 30; });
    EXPECT_GT(dark, static_cast<std::ptrdiff_t>(studio.pixels.size() * 3 / 4));
    EXPECT_GT(peak, 5);
}

TEST(ClearSky, SunRadiusDoesNotChangeItsIrradiance) {
    SkyOptions options;
    options.sun_direction = glm::normalize(Vec3(0.3f, 0.8f, 0.2f));
    const Vec3 wide = irradiance_over_pi(make_clear_sky(options, 64), options.sun_direction);
    options.sun_radius = 0.00465f;
    const Vec3 narrow = irradiance_over_pi(make_clear_sky(options, 64), options.sun_direction);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(wide[c], narrow[c], 0.01f * wide[c]);
}

TEST(ClearSky, EnergyIsBounded) {
    SkyOptions options;
    options.ground_albedo = Vec3(0);
    const Vec3 up = irradiance_over_pi(make_clear_sky(options, 64), Vec3(0, 1, 0)) * pi;
    // With the sun overhead, a horizontal plane gets most of the light at the top of the
    // atmosphere, but never more. Blue light is scattered out of the direct light, and part of it
    // goes back to space.
    EXPECT_LT(up.x, 1.0f);
    EXPECT_GT(up.z, 0.7f);
    EXPECT_GT(up.x, up.z);
}

TEST(AdjustLight, TurnsFromMinusZTowardsPlusX) {
    Image light(64, 32, 3, 0.0f);
    light.at(31, 16, 0) = 2;
    light.at(32, 16, 0) = 2;  // -Z
    const Image turned = adjust_light(light, 90, 1);
    EXPECT_FLOAT_EQ(turned.at(47, 16, 0), 4);
    EXPECT_FLOAT_EQ(turned.at(48, 16, 0), 4);  // +X
    EXPECT_FLOAT_EQ(turned.at(32, 16, 0), 0);
    EXPECT_GT(irradiance_over_pi(turned, Vec3(1, 0, 0)).x, 0);
    // A whole turn changes nothing, nor does a rotation by whole texels there and back.
    EXPECT_EQ(adjust_light(light, 360, 0).pixels, light.pixels);
    EXPECT_EQ(adjust_light(adjust_light(light, -45, 0), 45, 0).pixels, light.pixels);
    const Image between = adjust_light(light, 360.0f / 128, 0);
    EXPECT_FLOAT_EQ(between.at(32, 16, 0), 2);
    EXPECT_FLOAT_EQ(between.at(31, 16, 0), 1);
}

TEST(LoadLight, ReadsFilesAndExplainsWhatItCannotUse) {
    const std::filesystem::path folder = testing::TempDir();
    Image light(8, 4, 3, 0.5f);
    light.at(3, 2, 1) = 100;
    light.at(3, 2, 2) = -1;
    save_image(folder / "item3d_light.exr", light);
    const Image loaded = load_light((folder / "item3d_light.exr").string());
    EXPECT_EQ(loaded.width, 8);
    EXPECT_FLOAT_EQ(loaded.at(3, 2, 1), 100);
    EXPECT_FLOAT_EQ(loaded.at(3, 2, 2), 0);
    EXPECT_EQ(load_light("overcast").height, 256);

    light.at(0, 0, 0) = std::nanf("");
    save_image(folder / "item3d_light_nan.exr", light);
    save_image(folder / "item3d_light_black.hdr", Image(8, 4, 3));
    save_image(folder / "item3d_light_below.exr", Image(8, 4, 3, -0.5f));
    save_image(folder / "item3d_light_point.exr", Image(1, 1, 3, 1));
    for (const std::string name : {"item3d_light_black.hdr", "item3d_light_below.exr",
                                   "item3d_light_point.exr", "nothing.hdr"}) {
        EXPECT_THROW(load_light((folder / name).string()), InputError) << name;
    }
    EXPECT_EQ(load_light((folder / "item3d_light_nan.exr").string()).at(0, 0, 0), 0);  // warns
    // An image is read by its content, whatever its name, and as sRGB if it is a PNG.
    save_image(folder / "item3d_light.png", Image(8, 4, 3, 0.5f));
    std::filesystem::copy_file(folder / "item3d_light.png", folder / "item3d_light_png.hdr",
                               std::filesystem::copy_options::overwrite_existing);
    for (const std::string name : {"item3d_light.png", "item3d_light_png.hdr"})
        EXPECT_NEAR(load_light((folder / name).string()).at(0, 0, 0), 0.2158f, 2e-3f) << name;
    EXPECT_THROW(load_light("stduio"), InputError);
}

}  // namespace
}  // namespace item3d
