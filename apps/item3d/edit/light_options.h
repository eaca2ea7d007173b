// The options of `light` and `relight` that choose and change a light.
#pragma once

#include "item3d/lighting/adjust.h"
#include "item3d/lighting/description.h"
#include "item3d/scene/image.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <optional>
#include <string>

namespace item3d {

struct LightOptions {
    std::string layout = "auto";
    float rotation = 0;  ///< degrees
    float tilt = 0;      ///< degrees
    float exposure = 0;  ///< stops
    std::string tint;
    std::string sun;  ///< AZIMUTH,ELEVATION[,STRENGTH]
    std::string lit;  ///< a sentence that gives the direction of the light
    std::optional<float> strength;
    float sun_width = 3;  ///< degrees
};

/// Returns a check for numbers from `low` to `high`. Unlike CLI::Range, it refuses nan.
CLI::Validator number_between(float low, float high);

/// Adds --layout, --rotate, --tilt, --sun, --lit, --strength, --sun-width, --tint and --exposure.
void add_light_options(CLI::App& command, LightOptions& options);

/// Returns the sun of --sun or --lit, if given. Left and right refer to the default view. Throws
/// UsageError for a malformed value, and InputError for a sentence that names no direction. Warns
/// of unused words of --lit.
std::optional<SunSetting> chosen_sun(const LightOptions& options);

/// Returns the light changed by change_light(). sun: the result of chosen_sun().
Image apply(const LightOptions& options, const std::optional<SunSetting>& sun, const Image& light);

/// Returns all settings, and the sun's direction.
nlohmann::json settings_json(const LightOptions& options, const std::optional<SunSetting>& sun);

/// Returns the description as JSON: `{"dominant": {...}, "brightest_lobe": {...}, ...}`
/// (docs/relight.md).
nlohmann::json to_json(const LightDescription& description);
/// Returns the description as a few lines of text.
std::string to_text(const LightDescription& description);

/// Returns the light as an sRGB image of `width` pixels, exposed so that its content is visible.
Image light_image(const Image& light, int width);

}  // namespace item3d
