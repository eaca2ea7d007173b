// Extrapolation of an image beyond its covered texels.
#pragma once

#include "item3d/scene/image.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Sets each uncovered texel to the mean of its eight neighbours' known values, layer by layer
/// outwards. covered: [height * width], 0 for uncovered texels; channels: bit mask of the channels
/// to fill, bit c for channel c; layers: number of layers, or 0 to continue until the image is
/// full. Texels beyond the last layer get the mean of the covered texels, which compresses better.
void fill_uncovered(Image& image, const std::vector<std::uint8_t>& covered, unsigned channels = ~0u,
                    int layers = 0);

/// Does the same as fill_uncovered() for the RGBA image of a masked or blended material. Also fills
/// the colour of covered texels whose alpha is 0. Their colour is invisible, and the image
/// compresses better. Keeps their alpha.
void fill_invisible(Image& image, const std::vector<std::uint8_t>& covered, unsigned channels,
                    int layers);

/// Does the same as fill_uncovered() for an image of weights with one channel, except that weights
/// beyond `layers` become 0.
void continue_weights(Image& weight, const std::vector<std::uint8_t>& covered, int layers);

}  // namespace item3d
