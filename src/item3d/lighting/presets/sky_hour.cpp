#include "item3d/lighting/presets/sky_hour.h"

#include "item3d/core/error.h"
#include "item3d/lighting/description.h"
#include "item3d/lighting/environment.h"
#include "item3d/lighting/presets/sky_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace item3d {

namespace {

// Elevations of the sun in degrees.
constexpr float day = 20;
constexpr float sunset = 4;
constexpr float dusk = -1;  // below this elevation the moonlit sky is blended in
constexpr float night = -7;

/// Returns a number that rises linearly from 0 at `from` to 1 at `to`, and is constant beyond them.
float progress(float value, float from, float to) {
    return std::clamp((value - from) / (to - from), 0.0f, 1.0f);
}

}  // namespace

Vec3 sun_direction_at(float hour) {
    const float angle = (hour - 12) * pi / 12;
    const float half = std::sqrt(0.5f);
    return Vec3(-std::sin(angle), half * std::cos(angle), half * std::cos(angle));
}

Image make_sky_at(float hour, int height) {
    if (!(hour >= 0 && hour <= 24)) {
        throw InputError(fmt::format("sky at hour {}", hour), "expected an hour from 0 to 24");
    }
    const Vec3 sun = sun_direction_at(hour);
    const float elevation = to_sky_angles(sun).elevation;
    const float darkness = progress(elevation, dusk, night);
    Image sky(2 * height, height, 3);
    if (darkness < 1) {
        SkyOptions options;
        options.sun_direction = sun;
        options.haze = glm::mix(6.0f, 2.5f, progress(elevation, sunset, 30));
        options.ground_albedo = Vec3(0.21f, 0.19f, 0.16f);
        sky = make_clear_sky(options, height);
        const float peak = glm::mix(glm::mix(0.15f, 0.7f, progress(elevation, night, sunset)), 1.0f,
                                    progress(elevation, sunset, day));
        const float scale = peak * (1 - darkness) / peak_irradiance_over_pi(sky);
        for (float& value : sky.pixels)
            value *= scale;
    }
    if (darkness > 0) {
        const Image moonlit = make_light_preset("night", height);
        for (std::size_t i = 0; i < sky.pixels.size(); ++i)
            sky.pixels[i] += darkness * moonlit.pixels[i];
    }
    return sky;
}

}  // namespace item3d
