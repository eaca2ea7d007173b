// Choosing and changing a light by hand: the options that `light` and `relight` share.
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
    std::string lit;  ///< a sentence
    std::optional<float> strength;
    float sun_width = 3;  ///< degrees
};

/// Refuses what is not a number from `low` to `high`; CLI::Range lets nan pass.
CLI::Validator number_between(float low, float high);

/// Adds --layout, --rotate, --tilt, --sun, --lit, --strength, --sun-width, --tint and --exposure.
void add_light_options(CLI::App& command, LightOptions& options);

/// The sun that --sun or --lit asks for, if any. Left and right are those of the view that pictures
/// are drawn from by default. Throws UsageError for what is not written as it must be, InputError
/// for a sentence that names no direction; warns of words of --lit that are not used.
std::optional<SunSetting> chosen_sun(const LightOptions& options);

/// sun: of chosen_sun. The light as change_light() changes it.
Image apply(const LightOptions& options, const std::optional<SunSetting>& sun, const Image& light);

/// All settings, and the sun's direction.
nlohmann::json settings_json(const LightOptions& options, const std::optional<SunSetting>& sun);

/// `{"dominant": {...}, "brightest_lobe": {...}, ...}`, see docs/relight.md.
nlohmann::json to_json(const LightDescription& description);
/// The same for people, a few lines.
std::string to_text(const LightDescription& description);

/// The light itself as a picture in sRGB, bright enough to see what is in it, `width` pixels wide.
Image light_picture(const Image& light, int width);

}  // namespace item3d
