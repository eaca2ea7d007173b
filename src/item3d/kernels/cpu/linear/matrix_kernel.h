// The types and shapes that the matrix kernels share (matrix_tile.h).
//
//     maps     [images, height, width, channels]
//     columns  blocks of 64 output channels:  0 .. 63 | 64 .. 127 | .. | the rest, a multiple of 16
//
//     weights     float   BFloat16   Float16
//     multiplied  float   BFloat16   float, widened when they are loaded
//     summed      float   float      float
#pragma once

#include "item3d/kernels/cpu/bfloat16.h"
#include "item3d/kernels/cpu/dispatch.h"

#include <cstdint>

namespace item3d {

/// The type in which weights are multiplied. It is float for Float16, and the weights' own type
/// otherwise.
template <typename Weight>
struct MultipliedBy {
    using Number = Weight;
};
template <>
struct MultipliedBy<Float16> {
    using Number = float;
};
template <typename Weight>
using Multiplied = typename MultipliedBy<Weight>::Number;

/// Number of output channels in a block of packed weights. They fill four registers of AVX-512, and
/// the sums of six rows then fill 24 of its 32 registers (matrix_tile.h). The last block may be
/// narrower, but has whole registers.
constexpr std::int64_t packed_columns = 64;

inline std::int64_t columns_of(std::int64_t channels) {
    return (channels + packed_columns - 1) / packed_columns;
}

/// The shape of a 3x3 convolution with stride 1 and padding 1 over maps [images, height, width,
/// channels].
struct ConvolutionShape {
    std::int64_t images, height, width, in_channels, out_channels;

    /// Returns the number of squares of `tile` x `tile` pixels that cover the maps.
    std::int64_t tiles(int tile) const {
        return images * ((height + tile - 1) / tile) * ((width + tile - 1) / tile);
    }
    std::int64_t pixels() const { return images * height * width; }
};

}  // namespace item3d
