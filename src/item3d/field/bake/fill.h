// Extrapolation of an image beyond its covered texels.
#pragma once

#include "item3d/scene/image.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Sets each texel with covered == 0 to the mean of its eight neighbours' known values, layer by
/// layer outwards, in the channels of `channels` (bit c: channel c). layers: number of layers,
/// beyond which texels get the mean of the covered ones, which compresses better; 0: until the
/// image is full. covered: [height * width].
void fill_uncovered(Image& image, const std::vector<std::uint8_t>& covered, unsigned channels = ~0u,
                    int layers = 0);

/// Same as fill_uncovered(), for RGBA of a masked or blended material. Also fills the colour of
/// covered texels with alpha 0, which is invisible, for better compression. Keeps their alpha.
void fill_invisible(Image& image, const std::vector<std::uint8_t>& covered, unsigned channels,
                    int layers);

/// Same as fill_uncovered(), for an image of weights with one channel, except that weights beyond
/// `layers` become 0.
void continue_weights(Image& weight, const std::vector<std::uint8_t>& covered, int layers);

}  // namespace item3d
