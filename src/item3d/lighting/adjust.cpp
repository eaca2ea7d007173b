#include "item3d/lighting/adjust.h"

#include "item3d/core/error.h"
#include "item3d/lighting/environment.h"
#include "item3d/lighting/layout.h"
#include "item3d/lighting/sun_disk.h"

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

/// Strength of a new sun: strong enough for a clear direction, weak enough for light in the
/// shadows.
constexpr double usual_strength = 6;

}  // namespace

Image tilt_light(const Image& light, float degrees) {
    if (degrees == 0) return light;
    const float angle = degrees * pi / 180;
    const float cosine = std::cos(angle);
    const float sine = std::sin(angle);
    // The light in a direction comes from the direction before the rotation.
    return light_from(light.height, [&](Vec3 d) {
        return look_up(light, Vec3(d.x, cosine * d.y + sine * d.z, cosine * d.z - sine * d.y));
    });
}

Image tint_light(const Image& light, Vec3 linear_color) {
    const double brightness = luminance(linear_color);
    if (!(brightness > 0)) {
        throw InputError("tint", "black cannot be used as a tint",
                         "use a colour, or darken the light with the exposure");
    }
    const Vec3 factor = linear_color / static_cast<float>(brightness);
    Image tinted = light;
    for (std::size_t i = 0; i < tinted.pixels.size(); ++i)
        tinted.pixels[i] *= factor[static_cast<int>(i % 3)];
    return tinted;
}

Image without_lobe(const Image& light, const LightLobe& lobe) {
    const auto texel = static_cast<float>(M_PI / std::min(light.height, light.width / 2));
    const float rim = static_cast<float>(lobe.radius()) + 3 * texel;
    const float ring = rim + 4 * texel;
    glm::dvec3 sum(0);
    double weights = 0;
    std::vector<std::pair<int, int>> inside;
    for (int y = 0; y < light.height; ++y) {
        for (int x = 0; x < light.width; ++x) {
            const Vec3 d = equirectangular_direction((static_cast<float>(x) + 0.5f) / light.width,
                                                     (static_cast<float>(y) + 0.5f) / light.height);
            const float cosine = glm::dot(d, lobe.direction);
            if (cosine >= std::cos(rim)) {
                inside.emplace_back(x, y);
            } else if (cosine >= std::cos(ring)) {
                const double weight = texel_solid_angle(y, light.height);
                weights += weight;
                for (int c = 0; c < 3; ++c)
                    sum[c] += weight * light.at(x, y, c);
            }
        }
    }
    Image result = light;
    if (weights == 0) return result;
    for (const auto& [x, y] : inside) {
        for (int c = 0; c < 3; ++c)
            result.at(x, y, c) = std::min(light.at(x, y, c), static_cast<float>(sum[c] / weights));
    }
    return result;
}

Image place_sun(const Image& light, const SunSetting& setting) {
    const float peak = peak_irradiance_over_pi(light);
    const LightLobe lobe = brightest_lobe(light);
    Image result = light;
    glm::dvec3 color(1);
    if (lobe.is_sun()) {
        color = lobe.irradiance / luminance(lobe.irradiance);
        result = without_lobe(light, lobe);
    }
    const double rest = M_PI * luminance(mean_radiance(result));
    double irradiance = lobe.is_sun() ? luminance(lobe.irradiance) : usual_strength * rest;
    if (setting.strength) irradiance = *setting.strength * rest;
    // The irradiance of a black light is 0, so the sun's cannot be relative to it.
    if (rest == 0 && !lobe.is_sun()) irradiance = M_PI;
    add_sun_disk(result, {.direction = to_direction(setting.from),
                          .radius = setting.width / 2 * pi / 180,
                          .irradiance = irradiance * color,
                          .above_horizon = false});
    const float new_peak = peak_irradiance_over_pi(result);
    if (peak > 0 && new_peak > 0) {
        for (float& value : result.pixels)
            value *= peak / new_peak;
    }
    return result;
}

Image change_light(const Image& light, const LightChange& change) {
    Image result = tilt_light(adjust_light(light, change.rotation, 0), change.tilt);
    if (change.sun) result = place_sun(result, *change.sun);
    if (change.tint) result = tint_light(result, *change.tint);
    return adjust_light(result, 0, change.exposure);
}

}  // namespace item3d
