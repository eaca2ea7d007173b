// The kernel of 3x3 convolutions without transforms, on plain memory, for maps that are too small
// for winograd.h:
//
//     y[p][o] = bias[o] + sum_t sum_c weights[o][t][c] x[p + offset(t)][c]      x: 0 beyond edges
//
// p is a pixel, o an output channel, c an input channel, and t one of the nine taps, at the offset
// (t / 3 - 1, t % 3 - 1) in rows and columns. The sum over t adds nine matrix products [pixels, in]
// x [in, out]. The rows of their left factors are given by pointers into x, so no map of 9 * in
// channels is built.
//
//     x, y     [images, height, width, channels]
//     weights  [out, 3, 3, in]
//     packed   [9, out / 64, in / group, 64, group]
//
//     group 1:  o0 o1 ... o63 | o0 o1 ...        of channel c, then of channel c + 1
//     group 2:  o0c0 o0c1 o1c0 o1c1 ...          pairs of channels for one instruction (BFloat16)
#pragma once

#include "item3d/kernels/cpu/dispatch.h"
#include "item3d/kernels/cpu/linear/matrix_kernel.h"

namespace item3d {

/// A range of pixels over all images, and of output channels in whole blocks of 64.
struct PixelPart {
    std::int64_t first_pixel, last_pixel, first_channel, last_channel;
};

template <typename Weight>
struct DirectKernel {
    /// Packs the weights [64, 3, 3, in] of one block of output channels into their places in
    /// `packed`, [9, out / 64, in / group, 64, group]. The last block may have fewer than 64
    /// channels. `group` is the number of input channels that one instruction multiplies (2 for
    /// BFloat16, 1 for the other types). column: the block's first channel.
    void (*pack)(const Weight* weights, std::int64_t out_channels, std::int64_t in_channels,
                 std::int64_t column, Weight* packed);
    /// Returns the number of bytes of scratch memory, which must be aligned to 64 bytes, for a part
    /// of `pixels` pixels.
    std::int64_t (*scratch)(std::int64_t pixels, std::int64_t in_channels);
    /// Computes y = conv(x, weights) + bias for one part. bias: [out] or null.
    void (*convolve)(const ConvolutionShape& shape, const Multiplied<Weight>* x,
                     const Weight* packed, const float* bias, Multiplied<Weight>* y,
                     const PixelPart& part, void* scratch);
};

template <InstructionSet instructions, typename Weight>
DirectKernel<Weight> direct_kernel();
template <>
DirectKernel<float> direct_kernel<InstructionSet::avx2, float>();
template <>
DirectKernel<Float16> direct_kernel<InstructionSet::avx2, Float16>();
template <>
DirectKernel<float> direct_kernel<InstructionSet::avx512, float>();
template <>
DirectKernel<Float16> direct_kernel<InstructionSet::avx512, Float16>();
template <>
DirectKernel<BFloat16> direct_kernel<InstructionSet::avx512, BFloat16>();

}  // namespace item3d
