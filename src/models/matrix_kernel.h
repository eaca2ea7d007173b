// What the kernels that multiply matrices have in common; see matrix_tile.h.
#pragma once

#include "item3d/models/brain_float.h"

#include <cstdint>

namespace item3d {

/// Whether this processor has what the kernels for float or BrainFloat need, and gains by them: one
/// with matrix units multiplies bfloat16 faster on those.
template <typename Number>
bool matrix_kernel_runs();

/// Whether it has matrix units for bfloat16 (AMX) and the system lets programs use them.
bool matrix_units_run();

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

/// Output channels of a convolution are packed in columns of this many; input channels must be a
/// multiple of it too.
constexpr std::int64_t packed_columns = 64;

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
