// Lights of the training images, prefiltered once, with their phrases.
#pragma once

#include "item3d/core/random.h"
#include "item3d/prior/data/sky_visibility.h"
#include "item3d/render/prefilter/environment_light.h"

#include <string>
#include <vector>

namespace item3d {

struct TrainingLight {
    std::string kind;  ///< "plain" or one of light_kinds()
    /// Phrases that captions may append: " at sunset". One of them is "" if words are optional.
    std::vector<std::string> phrases;
    EnvironmentLight light;
    SkyLight sky;  ///< the same light, for shadows
};

/// Returns every kind except "plain": "studio", "sunset", ... Captions do not name the kind
/// "plain".
const std::vector<std::string>& light_kinds();
/// Returns TrainingLight::phrases of a kind, the most frequent first.
const std::vector<std::string>& light_phrases(const std::string& kind);

/// Draws a light: a room with lamps, or a preset at a random rotation. Rooms have bright and dark
/// parts, because metal in uniform light looks like paint. size: edge of the finest cube face, in
/// texels.
TrainingLight make_training_light(Random& random, const std::string& kind, int size = 64);

/// Makes `count` lights on `threads` threads, in the training's proportions: six in ten are plain.
std::vector<TrainingLight> make_training_lights(std::uint64_t seed, int count, int threads);

}  // namespace item3d
