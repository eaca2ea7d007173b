#include "item3d/lighting/environment.h"

#include "item3d/core/error.h"
#include "item3d/core/random.h"
#include "item3d/lighting/description.h"
#include "item3d/lighting/presets/sky_model.h"
#include "item3d/lighting/presets/studio.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace item3d {

namespace {

Vec3 direction_of(float azimuth_degrees, float elevation_degrees) {
    const float azimuth = azimuth_degrees * pi / 180;
    const float elevation = elevation_degrees * pi / 180;
    return Vec3(std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
                std::cos(elevation) * std::cos(azimuth));
}

/// Scales the light so that the largest irradiance / pi over all normals is `peak`.
void normalize_peak(Image& light, float peak) {
    const float scale = peak / peak_irradiance_over_pi(light);
    for (float& value : light.pixels)
        value *= scale;
}

/// CIE standard overcast sky (Moon and Spencer 1942): three times brighter at the zenith than at
/// the horizon, with faint clouds for interesting reflections.
Image overcast_sky(int height) {
    Image image(2 * height, height, 3);
    const auto value_noise = [](Vec2 p, std::uint64_t seed) {
        const auto corner = [&](float x, float y) {
            const auto cell = static_cast<std::uint64_t>(static_cast<std::int64_t>(x) * 73856093 ^
                                                         static_cast<std::int64_t>(y) * 19349663);
            return static_cast<float>(mix_bits(cell ^ mix_bits(seed)) >> 40) * 0x1.0p-24f;
        };
        const Vec2 base = glm::floor(p);
        const Vec2 f = glm::smoothstep(Vec2(0), Vec2(1), p - base);
        return glm::mix(glm::mix(corner(base.x, base.y), corner(base.x + 1, base.y), f.x),
                        glm::mix(corner(base.x, base.y + 1), corner(base.x + 1, base.y + 1), f.x),
                        f.y);
    };
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const Vec3 d = equirectangular_direction((x + 0.5f) / image.width, (y + 0.5f) / height);
            Vec3 radiance(0.3f, 0.295f, 0.28f);  // ground, albedo about 0.35
            if (d.y > 0) {
                // A layer of cloud on a curved plane: patches shrink towards the horizon.
                Vec2 p = Vec2(d.x, d.z) / (d.y + 0.35f) * 1.6f;
                float cloud = 0;
                float strength = 0.5f;
                for (std::uint64_t octave = 0; octave < 5; ++octave, strength *= 0.5f, p *= 2.1f) {
                    cloud += strength * (value_noise(p, octave) - 0.5f);
                }
                const float cie = (1 + 2 * d.y) / 3;
                radiance = cie * (1 + 0.55f * cloud) * Vec3(0.965f, 1.0f, 1.06f);
            }
            for (int c = 0; c < 3; ++c)
                image.at(x, y, c) = radiance[c];
        }
    }
    return image;
}

/// Moonlight is sunlight, 400 000 times dimmer; dark-adapted eyes see it bluish (Jensen et al.
/// 2000, "Night rendering"), so it is tinted blue here.
Image night_sky(int height) {
    SkyOptions options;
    options.sun_direction = direction_of(40, 38);
    options.sun_irradiance = Vec3(0.62f, 0.80f, 1.15f);
    options.ground_albedo = Vec3(0.10f, 0.11f, 0.12f);
    options.haze = 0.7f;
    Image image = make_clear_sky(options, height);
    Random random(2);
    for (int star = 0; star < 500; ++star) {
        const double y = random.uniform();
        const double angle = random.uniform(-M_PI, M_PI);
        const double brightness = std::pow(random.uniform(), 6.0);
        const double warmth = random.uniform(-0.15, 0.15);
        const double radius = std::sqrt(1 - y * y);
        const Vec2 uv =
            equirectangular_uv(Vec3(radius * std::sin(angle), y, radius * std::cos(angle)));
        const int column = std::min(static_cast<int>(uv.x * image.width), image.width - 1);
        const int row = std::min(static_cast<int>(uv.y * height), height - 1);
        // Air dims the stars near the horizon.
        const double flux =
            2e-4 * brightness * std::min(1.0, 4 * y) / texel_solid_angle(row, height);
        image.at(column, row, 0) += static_cast<float>(flux * (1 + warmth));
        image.at(column, row, 1) += static_cast<float>(flux);
        image.at(column, row, 2) += static_cast<float>(flux * (1 - warmth));
    }
    return image;
}

Image clear_sky(float azimuth, float elevation, float haze, Vec3 albedo, int height) {
    SkyOptions options;
    options.sun_direction = direction_of(azimuth, elevation);
    options.haze = haze;
    options.ground_albedo = albedo;
    return make_clear_sky(options, height);
}

}  // namespace

const std::vector<LightPreset>& light_presets() {
    static const std::vector<LightPreset> presets = {
        {"studio", 1, make_studio},
        {"noon", 1,
         [](int height) { return clear_sky(35, 58, 2.5f, Vec3(0.22f, 0.20f, 0.17f), height); }},
        {"sunset", 0.7f,
         [](int height) { return clear_sky(55, 4, 6, Vec3(0.20f, 0.18f, 0.15f), height); }},
        {"overcast", 1, overcast_sky},
        {"night", 0.15f, night_sky}};
    return presets;
}

std::vector<std::string> light_preset_names() {
    std::vector<std::string> names;
    for (const LightPreset& preset : light_presets())
        names.push_back(preset.name);
    return names;
}

bool is_light_preset(std::string_view name) {
    const std::vector<LightPreset>& presets = light_presets();
    return std::any_of(presets.begin(), presets.end(),
                       [&](const LightPreset& preset) { return preset.name == name; });
}

const std::string& light_presets_text() {
    static const std::string list = fmt::format("{}", fmt::join(light_preset_names(), ", "));
    return list;
}

Image make_light_preset(const std::string& name, int height) {
    ITEM3D_CHECK(height >= 8, "a light preset needs 8 rows");
    for (const LightPreset& preset : light_presets()) {
        if (preset.name != name) continue;
        Image image = preset.make(height);
        normalize_peak(image, preset.peak);
        return image;
    }
    throw InputError("light '" + name + "'", "unknown light preset",
                     "presets are " + light_presets_text());
}

Image adjust_light(const Image& light, float degrees, float exposure) {
    Image result(light.width, light.height, light.channels);
    const float scale = std::exp2(exposure);
    const double shift = static_cast<double>(degrees) / 360.0 * light.width;
    for (int x = 0; x < light.width; ++x) {
        double source = std::fmod(x - shift, static_cast<double>(light.width));
        if (source < 0) source += light.width;
        const int left = static_cast<int>(source) % light.width;
        const int right = (left + 1) % light.width;
        const auto weight = static_cast<float>(source - std::floor(source));
        for (int y = 0; y < light.height; ++y) {
            for (int c = 0; c < light.channels; ++c) {
                const float a = light.at(left, y, c);
                result.at(x, y, c) =
                    scale * (weight == 0 ? a : a + weight * (light.at(right, y, c) - a));
            }
        }
    }
    return result;
}

Vec3 equirectangular_direction(float u, float v) {
    const float azimuth = 2 * pi * (u - 0.5f);
    const float polar = pi * v;
    const float sine = std::sin(polar);
    return Vec3(sine * std::sin(azimuth), std::cos(polar), -sine * std::cos(azimuth));
}

Vec2 equirectangular_uv(Vec3 direction) {
    return Vec2(std::atan2(direction.x, -direction.z) / (2 * pi) + 0.5f,
                std::acos(std::clamp(direction.y, -1.0f, 1.0f)) / pi);
}

double texel_solid_angle(int y, int height) {
    const double top = std::cos(M_PI * y / height);
    const double bottom = std::cos(M_PI * (y + 1) / height);
    return 2 * M_PI / (2.0 * height) * (top - bottom);
}

Vec3 irradiance_over_pi(const Image& light, Vec3 normal) {
    glm::dvec3 sum(0);
    for (int y = 0; y < light.height; ++y) {
        // A row does not have 2 * height texels if the image is not 2:1.
        const double solid_angle =
            texel_solid_angle(y, light.height) * 2.0 * light.height / light.width;
        for (int x = 0; x < light.width; ++x) {
            const Vec3 d =
                equirectangular_direction((x + 0.5f) / light.width, (y + 0.5f) / light.height);
            const double weight = solid_angle * std::max(0.0f, glm::dot(d, normal));
            for (int c = 0; c < 3; ++c)
                sum[c] += weight * light.at(x, y, c);
        }
    }
    return Vec3(sum / M_PI);
}

}  // namespace item3d
