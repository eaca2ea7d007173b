// Winograd's convolution in three passes over a part's tiles (matrices: docs/kernels.md):
//
//     transform_input   V = B^T d B      [points, tiles, in]     columns of d first, then rows
//     multiply_rows     M_i = V_i U_i    [points, tiles, 64]     a product for each point i
//     transform_sums    Y = A^T M A      to y, plus bias; pixels beyond the edge are left out
//
// U = G g G^T is computed once, when the weights are packed. The transforms work on sixteen
// channels at a time, so that each element of d is a register of channels.
//
// Scratch memory, T = tiles rounded up to the rows that are multiplied at a time (6, on AMX 32):
//
//     transformed  Number [points, T, in]   |   sums  float [points, T, 64]
//
// The backward pass is the same convolution, with weights rotated by 180 degrees and with input and
// output channels swapped (frozen_convolution.h).
#include "item3d/kernels/cpu/conv/winograd_kernel.h"

#include "item3d/kernels/cpu/linear/matrix_tile.h"
#ifdef __AMX_BF16__
#include "item3d/kernels/cpu/amx.h"
#endif

#include <algorithm>
#include <type_traits>

namespace item3d {
namespace ITEM3D_INSTRUCTIONS {
namespace {

using std::int64_t;

// The one-dimensional transforms of weights (G), input (B^T) and sums (A^T); see Lavin & Gray
// (2016), "Fast Algorithms for Convolutional Neural Networks", sections 4.1 and 4.3. step: distance
// between neighbouring elements that are read; to_step: distance between neighbouring elements that
// are written.
template <int tile>
struct Transform;

template <>
struct Transform<2> {
    static void weights(const Lanes* g, int step, Lanes* to, int to_step) {
        const Lanes half = all(0.5f);
        const Lanes outer = g[0] + g[2 * step];
        to[0] = g[0];
        to[to_step] = half * (outer + g[step]);
        to[2 * to_step] = half * (outer - g[step]);
        to[3 * to_step] = g[2 * step];
    }
    static void input(const Lanes* d, int step, Lanes* to, int to_step) {
        to[0] = d[0] - d[2 * step];
        to[to_step] = d[step] + d[2 * step];
        to[2 * to_step] = d[2 * step] - d[step];
        to[3 * to_step] = d[step] - d[3 * step];
    }
    static void sums(const Lanes* s, int step, Lanes* to, int to_step) {
        to[0] = s[0] + s[step] + s[2 * step];
        to[to_step] = s[step] - s[2 * step] - s[3 * step];
    }
};

/// The interpolation points are 0, +-near, +-far and infinity. near and far are chosen for a small
/// error in float; with the paper's 1 and 2 the error is twice as large (docs/kernels.md,
/// docs/journal/benchmarks.md).
template <>
struct Transform<4> {
    static constexpr float near = 0.625f, far = 1.5f;
    static constexpr float near2 = near * near, far2 = far * far;

    static void weights(const Lanes* g, int step, Lanes* to, int to_step) {
        const Lanes at_near = all(1 / (2 * near2 * (near2 - far2)));
        const Lanes at_far = all(1 / (2 * far2 * (far2 - near2)));
        const Lanes near_even = at_near * (g[0] + all(near2) * g[2 * step]);
        const Lanes near_odd = at_near * (all(near) * g[step]);
        const Lanes far_even = at_far * (g[0] + all(far2) * g[2 * step]);
        const Lanes far_odd = at_far * (all(far) * g[step]);
        to[0] = all(1 / (near2 * far2)) * g[0];
        to[to_step] = near_even + near_odd;
        to[2 * to_step] = near_even - near_odd;
        to[3 * to_step] = far_even + far_odd;
        to[4 * to_step] = far_even - far_odd;
        to[5 * to_step] = g[2 * step];
    }
    static void input(const Lanes* d, int step, Lanes* to, int to_step) {
        const Lanes n = all(near), n2 = all(near2);
        const Lanes f = all(far), f2 = all(far2);
        const Lanes sum = all(near2 + far2), product = all(near2 * far2);
        const Lanes near_even = d[4 * step] - f2 * d[2 * step];
        const Lanes near_odd = n * (d[3 * step] - f2 * d[step]);
        const Lanes far_even = d[4 * step] - n2 * d[2 * step];
        const Lanes far_odd = f * (d[3 * step] - n2 * d[step]);
        to[0] = product * d[0] - sum * d[2 * step] + d[4 * step];
        to[to_step] = near_even + near_odd;
        to[2 * to_step] = near_even - near_odd;
        to[3 * to_step] = far_even + far_odd;
        to[4 * to_step] = far_even - far_odd;
        to[5 * to_step] = product * d[step] - sum * d[3 * step] + d[5 * step];
    }
    static void sums(const Lanes* s, int step, Lanes* to, int to_step) {
        const Lanes near_even = s[step] + s[2 * step], far_even = s[3 * step] + s[4 * step];
        const Lanes near_odd = all(near) * (s[step] - s[2 * step]);
        const Lanes far_odd = all(far) * (s[3 * step] - s[4 * step]);
        const Lanes n2 = all(near2), f2 = all(far2);
        to[0] = s[0] + near_even + far_even;
        to[to_step] = near_odd + far_odd;
        to[2 * to_step] = n2 * near_even + f2 * far_even;
        to[3 * to_step] = n2 * near_odd + f2 * far_odd + s[5 * step];
    }
};

/// Position of a tile.
struct Place {
    int64_t image, y, x;  ///< first output pixel

    Place(const ConvolutionShape& shape, int tile, int64_t index) {
        const int64_t across = (shape.width + tile - 1) / tile;
        const int64_t down = (shape.height + tile - 1) / tile;
        image = index / across / down;
        y = index / across % down * tile;
        x = index % across * tile;
    }
};

/// Transforms the input pixels of the tiles [first, last) to [points, stride, in_channels]. stride:
/// number of tiles of the part, padded (rows_for()).
template <typename Number>
void transform_input(const ConvolutionShape& shape, const Number* x, int64_t first, int64_t last,
                     int64_t stride, Number* transformed) {
    constexpr int tile = winograd_tile<Number>, side = tile + 2, points = side * side;
    const int64_t channels = shape.in_channels;
    for (int64_t t = first; t < last; ++t) {
        const Place place(shape, tile, t);
        const Number* pixels[points];  // null beyond the edge
        for (int i = 0; i < side; ++i) {
            for (int j = 0; j < side; ++j) {
                const int64_t row = place.y - 1 + i, column = place.x - 1 + j;
                const bool inside =
                    row >= 0 && row < shape.height && column >= 0 && column < shape.width;
                const int64_t pixel = (place.image * shape.height + row) * shape.width + column;
                pixels[i * side + j] = inside ? x + pixel * channels : nullptr;
            }
        }
        for (int64_t c = 0; c < channels; c += lanes) {
            Lanes d[points], half[points];
#pragma GCC unroll 36
            for (int i = 0; i < points; ++i)
                d[i] = pixels[i] ? load(pixels[i] + c) : zero();
#pragma GCC unroll 6
            for (int j = 0; j < side; ++j)
                Transform<tile>::input(d + j, side, half + j, side);
#pragma GCC unroll 6
            for (int i = 0; i < side; ++i)
                Transform<tile>::input(half + i * side, 1, d + i * side, 1);
            Number* to = transformed + (t - first) * channels + c;
#pragma GCC unroll 36
            for (int i = 0; i < points; ++i)
                store(to + i * stride * channels, d[i]);
        }
    }
}

/// Transforms sums [points, stride, packed_columns] to the tiles' output pixels, in `columns`
/// channels from `channel` on.
template <typename Number>
void transform_sums(const ConvolutionShape& shape, const float* sums, const float* bias,
                    int64_t first, int64_t last, int64_t stride, int64_t channel, int64_t columns,
                    Number* y) {
    constexpr int tile = winograd_tile<Number>, side = tile + 2, points = side * side;
    for (int64_t t = first; t < last; ++t) {
        const Place place(shape, tile, t);
        for (int64_t c = 0; c < columns; c += lanes) {
            Lanes s[points], half[tile * side], pixels[tile * tile];
#pragma GCC unroll 36
            for (int i = 0; i < points; ++i)
                s[i] = load(sums + (i * stride + t - first) * packed_columns + c);
#pragma GCC unroll 6
            for (int j = 0; j < side; ++j)
                Transform<tile>::sums(s + j, side, half + j, side);
#pragma GCC unroll 4
            for (int i = 0; i < tile; ++i)
                Transform<tile>::sums(half + i * side, 1, pixels + i * tile, 1);
            const Lanes add = bias ? load(bias + channel + c) : zero();
#pragma GCC unroll 4
            for (int i = 0; i < tile; ++i)
#pragma GCC unroll 4
                for (int j = 0; j < tile; ++j) {
                    const int64_t row = place.y + i, column = place.x + j;
                    if (row >= shape.height || column >= shape.width) continue;
                    const int64_t pixel = (place.image * shape.height + row) * shape.width + column;
                    store(y + pixel * shape.out_channels + channel + c, pixels[i * tile + j] + add);
                }
        }
    }
}

template <typename Number>
void pack_winograd_weights(const Number* weights, int64_t out_channels, int64_t in_channels,
                           int64_t column, Number* packed) {
    using Maths = Arithmetic<Number>;
    constexpr int tile = winograd_tile<Number>, side = tile + 2, points = side * side;
    const int64_t columns = std::min(packed_columns, out_channels - column);
    for (int64_t c = 0; c < in_channels; c += lanes) {
        for (int64_t o = 0; o < columns; ++o) {
            Lanes g[9], half[3 * side], u[points];
            const Number* from = weights + o * 9 * in_channels + c;
#pragma GCC unroll 9
            for (int i = 0; i < 9; ++i)
                g[i] = load(from + i * in_channels);
#pragma GCC unroll 3
            for (int j = 0; j < 3; ++j)
                Transform<tile>::weights(g + j, 3, half + j, 3);
#pragma GCC unroll 6
            for (int i = 0; i < side; ++i)
                Transform<tile>::weights(half + i * 3, 1, u + i * side, 1);
            Number* to = packed + column * in_channels + c * columns + o * Maths::group;
#pragma GCC unroll 36
            for (int i = 0; i < points; ++i)
                Maths::scatter(to + i * out_channels * in_channels, static_cast<int>(columns),
                               u[i]);
        }
    }
}

#ifdef __AMX_BF16__
template <typename Number>
bool in_units() {
    return std::is_same_v<Number, BFloat16> && amx_available();
}
#endif

/// Returns the number of rows for `tiles` tiles, padded to a multiple of the rows that are
/// multiplied at a time.
template <typename Number>
int64_t rows_for(int64_t tiles) {
#ifdef __AMX_BF16__
    if (in_units<Number>()) return units::whole_rows(tiles);
#endif
    return whole_rows(tiles);
}

/// Computes the first `columns` columns of sums [count, packed_columns], the product of a [count,
/// depth] and b. count: from rows_for(); next: as in units::multiply().
template <typename Number>
void multiply_rows(const Number* a, int64_t count, int64_t depth, const Number* b, int64_t columns,
                   [[maybe_unused]] const Number* next, float* sums) {
#ifdef __AMX_BF16__
    if constexpr (std::is_same_v<Number, BFloat16>)
        if (in_units<Number>()) {
            const units::Tiles tiles;
            const auto tile = [&](int64_t i) { return a + i * units::tile_rows * depth; };
            return units::multiply(tile, count, depth, b, next, sums, false);
        }
#endif
    for (int64_t r = 0; r < count; r += rows) {
        const Number* at[rows];
        for (int j = 0; j < rows; ++j)
            at[j] = a + (r + j) * depth;
        multiply(columns, at, depth, b, sums + r * packed_columns, packed_columns, false);
    }
}

template <typename Number>
int64_t winograd_scratch(int64_t tiles, int64_t in_channels) {
    return winograd_points<Number> * rows_for<Number>(tiles) *
           (in_channels * static_cast<int64_t>(sizeof(Number)) +
            packed_columns * static_cast<int64_t>(sizeof(float)));
}

template <typename Number>
void convolve_winograd(const ConvolutionShape& shape, const Number* x, const Number* packed,
                       const float* bias, Number* y, const WinogradPart& part, void* scratch) {
    constexpr int points = winograd_points<Number>;
    const int64_t channels = shape.in_channels, first = part.first_tile, last = part.last_tile;
    // The padding may have arbitrary values, because its results are ignored.
    const int64_t stride = rows_for<Number>(last - first);
    auto* transformed = static_cast<Number*>(scratch);
    auto* sums = reinterpret_cast<float*>(transformed + points * stride * channels);
    transform_input(shape, x, first, last, stride, transformed);
    const auto panel = [&](int64_t channel, int64_t point) {
        return packed + (point * shape.out_channels + channel) * channels;
    };
    for (int64_t channel = part.first_channel; channel < part.last_channel;
         channel += packed_columns) {
        const int64_t columns = std::min(packed_columns, part.last_channel - channel);
        for (int64_t i = 0; i < points; ++i) {
            const bool ends = i + 1 == points,
                       ends_all = channel + packed_columns >= part.last_channel;
            const Number* next = !ends      ? panel(channel, i + 1)
                                 : ends_all ? panel(part.first_channel, 0)
                                            : panel(channel + packed_columns, 0);
            multiply_rows(transformed + i * stride * channels, stride, channels, panel(channel, i),
                          columns, next, sums + i * stride * packed_columns);
        }
        transform_sums(shape, sums, bias, first, last, stride, channel, columns, y);
    }
}

template <typename Number>
constexpr WinogradKernel<Number> winograd_functions{
    pack_winograd_weights<Number>, winograd_scratch<Number>, convolve_winograd<Number>};

}  // namespace
}  // namespace ITEM3D_INSTRUCTIONS

template <>
WinogradKernel<float> winograd_kernel<InstructionSet::ITEM3D_INSTRUCTIONS, float>() {
    return ITEM3D_INSTRUCTIONS::winograd_functions<float>;
}

#ifdef __AVX512BF16__
template <>
WinogradKernel<BFloat16> winograd_kernel<InstructionSet::avx512, BFloat16>() {
    return avx512::winograd_functions<BFloat16>;
}
#endif

}  // namespace item3d
