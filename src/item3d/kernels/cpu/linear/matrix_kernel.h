// What the kernels that multiply matrices have in common; see matrix_tile.h.
#pragma once

#include "item3d/kernels/cpu/bfloat16.h"
#include "item3d/kernels/cpu/dispatch.h"

#include <cstdint>

namespace item3d {

/// What weights of a type are multiplied by: numbers of the same type, but float where they are
/// kept as files have them.
template <typename Weight>
struct MultipliedBy {
    using Number = Weight;
};
template <>
struct MultipliedBy<HalfFloat> {
    using Number = float;
};
template <typename Weight>
using Multiplied = typename MultipliedBy<Weight>::Number;

/// Output channels are packed in columns of this many, the last of them as narrow as whole
/// registers allow.
constexpr std::int64_t packed_columns = 64;

inline std::int64_t columns_of(std::int64_t channels) {
    return (channels + packed_columns - 1) / packed_columns;
}

/// A 3x3 convolution of stride 1 and padding 1 over maps in memory as [pictures, height, width,
/// channels].
struct ConvolutionShape {
    std::int64_t pictures, height, width, in_channels, out_channels;

    /// Squares of `tile` pixels a side that cover the maps.
    std::int64_t tiles(int tile) const {
        return pictures * ((height + tile - 1) / tile) * ((width + tile - 1) / tile);
    }
    std::int64_t pixels() const { return pictures * height * width; }
};

}  // namespace item3d
