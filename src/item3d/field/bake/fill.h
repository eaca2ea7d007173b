// Continues an image beyond the texels that are covered.
#pragma once

#include "item3d/scene/image.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Gives each texel with covered == 0 the mean of its neighbours (of eight) that have a value
/// already, layer by layer outwards, in the channels of `channels` (bit c: channel c). layers:
/// so many, and the mean of what is covered beyond, which compresses better; 0: until the image is
/// full. covered: [height * width].
void fill_uncovered(Image& image, const std::vector<std::uint8_t>& covered, unsigned channels = ~0u,
                    int layers = 0);

/// The same for RGBA that is cut out or blended: the colour of texels whose alpha is 0 is nobody's,
/// so it is filled as well, and compresses. Their alpha stays.
void fill_invisible(Image& image, const std::vector<std::uint8_t>& covered, unsigned channels,
                    int layers);

/// The same for weights of one channel: within `layers` of what is covered they go on, beyond they
/// are 0.
void continue_weights(Image& weight, const std::vector<std::uint8_t>& covered, int layers);

}  // namespace item3d
