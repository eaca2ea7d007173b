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

}  // namespace item3d
