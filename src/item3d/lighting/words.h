// Directions of light as people say them: "lit from the left", "sun low in the east".
#pragma once

#include "item3d/lighting/description.h"

#include <optional>
#include <string>
#include <vector>

namespace item3d {

struct LightWords {
    /// Where the light comes from; none where the sentence says nothing of it, or things that
    /// cancel
    /// ("from the left and the right").
    std::optional<SkyAngles> from;
    /// The sentence without its words of direction: "golden evening light" of "golden evening light
    /// from the left". Empty where only words like "lit" or "sun" would remain.
    std::string rest;
};

/// viewer_azimuth: where the camera stands, degrees as in SkyAngles. To it belong "from the camera"
/// (or front), left and right as it sees them, and "behind", which is beyond the model. Compass
/// words do not depend on it: north is -Z, east +X. On the clock the model is in the middle, the
/// camera at 6 and what it looks towards at 12 o'clock. Directions that are named together are
/// added up.
LightWords parse_light_words(const std::string& sentence, float viewer_azimuth);

/// What parse_light_words understands, a line for each kind of word; for help and errors.
const std::vector<std::string>& light_words_help();

}  // namespace item3d
