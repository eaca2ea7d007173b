// The lights of the training pictures, prefiltered once, with the words that describe them.
#pragma once

#include "item3d/core/random.h"
#include "item3d/prior/data/sky_visibility.h"
#include "item3d/render/prefilter/environment_light.h"

#include <string>
#include <vector>

namespace item3d {

struct TrainingLight {
    std::string kind;  ///< "plain" or one of light_kinds()
    /// What captions may append: " at sunset". One of them is "" where words are optional.
    std::vector<std::string> phrases;
    EnvironmentLight light;
    SkyLight sky;  ///< the same light, for shadows
};

/// Every kind but "plain", which has no words: "studio", "sunset", ...
const std::vector<std::string>& light_kinds();
/// TrainingLight::phrases of a kind, the commonest first.
const std::vector<std::string>& light_phrases(const std::string& kind);

/// Draws one: a room with lamps, or a preset turned at random. Rooms have bright and dark parts,
/// because an even light shows metal as paint. size: edge of the finest cube face.
TrainingLight make_training_light(Random& random, const std::string& kind, int size = 64);

/// `count` of them in the training's proportions (six in ten plain), on `threads` threads.
std::vector<TrainingLight> make_training_lights(std::uint64_t seed, int count, int threads);

}  // namespace item3d
