// The kernels of winograd.h on plain memory. They use Winograd's minimal filtering F(m x m, 3 x 3)
// (Lavin & Gray 2016, "Fast Algorithms for Convolutional Neural Networks", sections 4.1 and 4.3),
//
//     Y = A^T [ (G g G^T) * (B^T d B) ] A        * element by element
//
// which computes the m^2 outputs Y from a tile d of (m + 2)^2 pixels and a kernel g of 3 x 3
// weights. It takes (m + 2)^2 multiplications. The (m + 2)^2 elements of the product are called
// points. For each point, the sum over the input channels is a matrix product. docs/kernels.md
// derives the matrices A, B and G.
//
//     maps    [images, height, width, channels]; tiles row by row, the last ones cut by the edge
//     packed  [points, out / 64, in / group, 64, group]      point 6 i + j of 36, 4 i + j of 16
//
//     m = 4                 m = 2
//     . . . . . .           . . . .       . a pixel of d; neighbouring tiles overlap by two
//     . o o o o .           . o o .       o a pixel of d and of Y
//     . o o o o .           . o o .
//     . o o o o .           . . . .
//     . o o o o .
//     . . . . . .
#pragma once

#include "item3d/kernels/cpu/dispatch.h"
#include "item3d/kernels/cpu/linear/matrix_kernel.h"

#include <cstdint>

namespace item3d {

/// Edge of a tile in output pixels, which is m of F(m x m, 3 x 3) in Lavin & Gray's notation. For
/// each pair of an input and an output channel, a tile takes (m + 2)^2 multiplications instead of 9
/// m^2. The error with m = 4 is about three times the error with m = 2 (docs/kernels.md), which is
/// acceptable for float but not for bfloat16.
template <typename Number>
constexpr int winograd_tile = sizeof(Number) == 4 ? 4 : 2;

/// Number of points in a transformed tile.
template <typename Number>
constexpr int winograd_points = (winograd_tile<Number> + 2) * (winograd_tile<Number> + 2);

/// A range of tiles, and of output channels in whole blocks of 64.
struct WinogradPart {
    std::int64_t first_tile, last_tile, first_channel, last_channel;
};

template <typename Number>
struct WinogradKernel {
    /// Transforms the weights [64, 3, 3, in] of one block of output channels into their places in
    /// `packed`. This has winograd_points * out * in numbers, in the order of DirectKernel::pack().
    /// The last block may have fewer than 64 channels. column: the block's first channel.
    void (*pack)(const Number* weights, std::int64_t out_channels, std::int64_t in_channels,
                 std::int64_t column, Number* packed);
    /// Returns the number of bytes of scratch memory, which must be aligned to 64 bytes, for a part
    /// of `tiles` tiles.
    std::int64_t (*scratch)(std::int64_t tiles, std::int64_t in_channels);
    /// Computes y = conv(x, weights) + bias for one part. bias: [out] or null.
    void (*convolve)(const ConvolutionShape& shape, const Number* x, const Number* packed,
                     const float* bias, Number* y, const WinogradPart& part, void* scratch);
};

template <InstructionSet instructions, typename Number>
WinogradKernel<Number> winograd_kernel();
template <>
WinogradKernel<float> winograd_kernel<InstructionSet::avx2, float>();
template <>
WinogradKernel<float> winograd_kernel<InstructionSet::avx512, float>();
template <>
WinogradKernel<BFloat16> winograd_kernel<InstructionSet::avx512, BFloat16>();

}  // namespace item3d
