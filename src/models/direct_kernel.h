// 3x3 convolutions without transforms on plain memory, for maps too small for winograd.h: AVX-512,
// compiled for it alone (src/CMakeLists.txt), so nothing here may be called where
// matrix_kernel_runs() says no.
#pragma once

#include "item3d/models/matrix_kernel.h"

namespace item3d {

/// Weights [64, 3, 3, in] of the output channels from `column` on, to their places in `packed`, [9,
/// out / 64, in / group, 64, group]. A group is the input channels that one instruction multiplies
/// (2 of BrainFloat, 1 of the others).
template <typename Weight>
void pack_taps(const Weight* weights, std::int64_t out_channels, std::int64_t in_channels,
               std::int64_t column, Weight* packed);

/// Pixels of all pictures together, and output channels in whole columns.
struct PixelPart {
    std::int64_t first_pixel, last_pixel, first_channel, last_channel;
};

/// Bytes of scratch memory (64-byte aligned) for a part of `pixels` pixels.
template <typename Number>
std::int64_t taps_scratch(std::int64_t pixels, std::int64_t in_channels);

/// y = conv(x, weights) + bias, for one part. bias: [out] or null.
template <typename Weight>
void convolve_taps(const ConvolutionShape& shape, const Multiplied<Weight>* x, const Weight* packed,
                   const float* bias, Multiplied<Weight>* y, const PixelPart& part, void* scratch);

// The same on matrix units, which want rows at equal distances: maps are given three times, each
// column's left neighbour, itself, and its right neighbour in its place.

/// Sixteen pixels of one picture make a tile.
inline std::int64_t unit_tiles(const ConvolutionShape& shape) {
    constexpr std::int64_t pixels = 16;
    return shape.pictures * ((shape.height * shape.width + pixels - 1) / pixels);
}

/// Tiles of all pictures together, and output channels in whole columns.
struct TilePart {
    std::int64_t first_tile, last_tile, first_channel, last_channel;
};

/// Bytes of scratch memory (64-byte aligned) for a part of `tiles` tiles.
std::int64_t unit_taps_scratch(std::int64_t tiles);

/// y = conv(x, weights) + bias, for one part. shifted: [3, pictures, height + 2, width, in], zero
/// where there is no neighbour and in the first and last rows, and sixteen pixels of anything.
void convolve_taps_in_units(const ConvolutionShape& shape, const BrainFloat* shifted,
                            const BrainFloat* packed, const float* bias, BrainFloat* y,
                            const TilePart& part, void* scratch);

}  // namespace item3d
