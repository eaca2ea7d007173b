// Parsing of a light's direction in words: "lit from the left", "sun low in the east".
#pragma once

#include "item3d/lighting/description.h"

#include <optional>
#include <string>
#include <vector>

namespace item3d {

struct LightWords {
    /// Direction of the light; no value if the sentence has no words of direction, or they cancel
    /// ("from the left and the right").
    std::optional<SkyAngles> from;
    /// The sentence without its words of direction, for example "golden evening light" for "golden
    /// evening light from the left". Empty where only words like "lit" or "sun" would remain.
    std::string rest;
};

/// viewer_azimuth: azimuth of the camera, degrees as in SkyAngles. "From the camera" (or front),
/// left, right, and "behind" (beyond the model) are relative to it. Compass words are not: north is
/// -Z, east +X. On a clock the model is at the centre, the camera at 6 and its viewing direction at
/// 12 o'clock. Several directions are added as vectors.
LightWords parse_light_words(const std::string& sentence, float viewer_azimuth);

/// Returns the supported words, a line for each kind; for help and errors.
const std::vector<std::string>& light_words_help();

}  // namespace item3d
