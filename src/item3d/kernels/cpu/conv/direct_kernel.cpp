// The direct convolution. For one block of 64 output channels, the sums of all pixels stay in
// scratch memory while the nine taps are added to them:
//
//     for each tap
//         for each six pixels           a: pointers to the input pixels under the tap; beyond an
//             sums += a * panel         edge, to `outside`, zeros; skipped if all are outside
//     y = sums + bias
//
// Scratch memory:   sums  float [pixels rounded up to 6, 64]   |   outside  Number [in]
//
// The outer loop is over the taps, so that the weights of a tap, the panel [in, 64], stay in the
// cache for all pixels of the part.
#include "item3d/kernels/cpu/conv/direct_kernel.h"

#include "item3d/kernels/cpu/linear/matrix_tile.h"

#include <algorithm>
#include <cstring>

namespace item3d {
namespace ITEM3D_INSTRUCTIONS {
namespace {

using std::int64_t;

constexpr int taps = 9;

/// Finds the pixel under one tap for each of `rows` output pixels from `first` on. The result is
/// `outside` for pixels beyond the edge, and after `last`. Returns false if all pixels are outside.
template <typename Number>
bool find_pixels(const ConvolutionShape& shape, const Number* x, const Number* outside, int tap,
                 int64_t first, int64_t last, const Number** found) {
    const int64_t down = tap / 3 - 1, right = tap % 3 - 1;
    bool any = false;
    for (int i = 0; i < rows; ++i) {
        const int64_t pixel = first + i;
        const int64_t row = pixel / shape.width % shape.height + down;
        const int64_t column = pixel % shape.width + right;
        const bool inside =
            pixel < last && row >= 0 && row < shape.height && column >= 0 && column < shape.width;
        found[i] = inside ? x + (pixel + down * shape.width + right) * shape.in_channels : outside;
        any = any || inside;
    }
    return any;
}

template <typename Weight>
void pack_taps(const Weight* weights, int64_t out_channels, int64_t in_channels, int64_t column,
               Weight* packed) {
    using Maths = Arithmetic<Weight>;
    const int64_t columns = std::min(packed_columns, out_channels - column);
    for (int tap = 0; tap < taps; ++tap) {
        Weight* to = packed + (tap * out_channels + column) * in_channels;
        for (int64_t o = 0; o < columns; ++o) {
            const Weight* from = weights + (o * taps + tap) * in_channels;
            for (int64_t c = 0; c < in_channels; c += lanes)
                Maths::scatter(to + c * columns + o * Maths::group, static_cast<int>(columns),
                               load(from + c));
        }
    }
}

template <typename Number>
int64_t taps_scratch(int64_t pixels, int64_t in_channels) {
    return whole_rows(pixels) * packed_columns * static_cast<int64_t>(sizeof(float)) +
           in_channels * static_cast<int64_t>(sizeof(Number));
}

template <typename Weight>
void convolve_taps(const ConvolutionShape& shape, const Multiplied<Weight>* x, const Weight* packed,
                   const float* bias, Multiplied<Weight>* y, const PixelPart& part, void* scratch) {
    using Number = Multiplied<Weight>;
    const int64_t in = shape.in_channels, out = shape.out_channels;
    const int64_t pixels = part.last_pixel - part.first_pixel;
    auto* sums = static_cast<float*>(scratch);
    auto* outside = reinterpret_cast<Number*>(sums + whole_rows(pixels) * packed_columns);
    std::memset(outside, 0, static_cast<std::size_t>(in) * sizeof(Number));
    for (int64_t channel = part.first_channel; channel < part.last_channel;
         channel += packed_columns) {
        const int64_t columns = std::min(packed_columns, part.last_channel - channel);
        std::memset(sums, 0,
                    static_cast<std::size_t>(whole_rows(pixels) * packed_columns) * sizeof(float));
        for (int tap = 0; tap < taps; ++tap) {
            const Weight* b = packed + (tap * out + channel) * in;
            for (int64_t r = 0; r < pixels; r += rows) {
                const Number* a[rows];
                if (find_pixels(shape, x, outside, tap, part.first_pixel + r, part.last_pixel, a))
                    multiply(columns, a, in, b, sums + r * packed_columns, packed_columns, true);
            }
        }
        for (int64_t r = 0; r < pixels; ++r) {
            for (int64_t c = 0; c < columns; c += lanes) {
                const Lanes add = bias ? load(bias + channel + c) : zero();
                store(y + (part.first_pixel + r) * out + channel + c,
                      load(sums + r * packed_columns + c) + add);
            }
        }
    }
}

template <typename Weight>
constexpr DirectKernel<Weight> direct_functions{pack_taps<Weight>, taps_scratch<Multiplied<Weight>>,
                                                convolve_taps<Weight>};

}  // namespace
}  // namespace ITEM3D_INSTRUCTIONS

template <>
DirectKernel<float> direct_kernel<InstructionSet::ITEM3D_INSTRUCTIONS, float>() {
    return ITEM3D_INSTRUCTIONS::direct_functions<float>;
}

template <>
DirectKernel<Float16> direct_kernel<InstructionSet::ITEM3D_INSTRUCTIONS, Float16>() {
    return ITEM3D_INSTRUCTIONS::direct_functions<Float16>;
}

#ifdef __AVX512BF16__
template <>
DirectKernel<BFloat16> direct_kernel<InstructionSet::avx512, BFloat16>() {
    return avx512::direct_functions<BFloat16>;
}
#endif

}  // namespace item3d
