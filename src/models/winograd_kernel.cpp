#include "item3d/models/winograd_kernel.h"

#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512VL__) && \
    defined(__AVX512BF16__)
#define ITEM3D_WINOGRAD 1
#include "item3d/models/matrix_tile.h"
#include "item3d/models/matrix_units.h"
#endif

#include <type_traits>

namespace item3d {

#ifdef ITEM3D_WINOGRAD

namespace {

using std::int64_t;

using avx512::lanes;
using avx512::load;
using avx512::rows;
using avx512::store;

// The transforms in one direction, Lavin & Gray (2016), "Fast Algorithms for Convolutional Neural
// Networks", sections 4.1 and 4.3: of weights (G), input (B^T) and sums (A^T). `step` is the
// distance of neighbours.
template <int tile>
struct Transform;

template <>
struct Transform<2> {
    static void weights(const __m512* g, int step, __m512* to, int to_step) {
        const __m512 half = _mm512_set1_ps(0.5f);
        const __m512 outer = g[0] + g[2 * step];
        to[0] = g[0];
        to[to_step] = half * (outer + g[step]);
        to[2 * to_step] = half * (outer - g[step]);
        to[3 * to_step] = g[2 * step];
    }
    static void input(const __m512* d, int step, __m512* to, int to_step) {
        to[0] = d[0] - d[2 * step];
        to[to_step] = d[step] + d[2 * step];
        to[2 * to_step] = d[2 * step] - d[step];
        to[3 * to_step] = d[step] - d[3 * step];
    }
    static void sums(const __m512* s, int step, __m512* to, int to_step) {
        to[0] = s[0] + s[step] + s[2 * step];
        to[to_step] = s[step] - s[2 * step] - s[3 * step];
    }
};

/// At 0, +-near, +-far and infinity. The paper's 1 and 2 err twice as much.
template <>
struct Transform<4> {
    static constexpr float near = 0.625f, far = 1.5f;
    static constexpr float near2 = near * near, far2 = far * far;

    static void weights(const __m512* g, int step, __m512* to, int to_step) {
        const __m512 at_near = _mm512_set1_ps(1 / (2 * near2 * (near2 - far2)));
        const __m512 at_far = _mm512_set1_ps(1 / (2 * far2 * (far2 - near2)));
        const __m512 near_even = at_near * (g[0] + _mm512_set1_ps(near2) * g[2 * step]);
        const __m512 near_odd = at_near * (_mm512_set1_ps(near) * g[step]);
        const __m512 far_even = at_far * (g[0] + _mm512_set1_ps(far2) * g[2 * step]);
        const __m512 far_odd = at_far * (_mm512_set1_ps(far) * g[step]);
        to[0] = _mm512_set1_ps(1 / (near2 * far2)) * g[0];
        to[to_step] = near_even + near_odd;
        to[2 * to_step] = near_even - near_odd;
        to[3 * to_step] = far_even + far_odd;
        to[4 * to_step] = far_even - far_odd;
        to[5 * to_step] = g[2 * step];
    }
    static void input(const __m512* d, int step, __m512* to, int to_step) {
        const __m512 n = _mm512_set1_ps(near), n2 = _mm512_set1_ps(near2);
        const __m512 f = _mm512_set1_ps(far), f2 = _mm512_set1_ps(far2);
        const __m512 sum = _mm512_set1_ps(near2 + far2), product = _mm512_set1_ps(near2 * far2);
        const __m512 near_even = d[4 * step] - f2 * d[2 * step];
        const __m512 near_odd = n * (d[3 * step] - f2 * d[step]);
        const __m512 far_even = d[4 * step] - n2 * d[2 * step];
        const __m512 far_odd = f * (d[3 * step] - n2 * d[step]);
        to[0] = product * d[0] - sum * d[2 * step] + d[4 * step];
        to[to_step] = near_even + near_odd;
        to[2 * to_step] = near_even - near_odd;
        to[3 * to_step] = far_even + far_odd;
        to[4 * to_step] = far_even - far_odd;
        to[5 * to_step] = product * d[step] - sum * d[3 * step] + d[5 * step];
    }
    static void sums(const __m512* s, int step, __m512* to, int to_step) {
        const __m512 near_even = s[step] + s[2 * step], far_even = s[3 * step] + s[4 * step];
        const __m512 near_odd = _mm512_set1_ps(near) * (s[step] - s[2 * step]);
        const __m512 far_odd = _mm512_set1_ps(far) * (s[3 * step] - s[4 * step]);
        const __m512 n2 = _mm512_set1_ps(near2), f2 = _mm512_set1_ps(far2);
        to[0] = s[0] + near_even + far_even;
        to[to_step] = near_odd + far_odd;
        to[2 * to_step] = n2 * near_even + f2 * far_even;
        to[3 * to_step] = n2 * near_odd + f2 * far_odd + s[5 * step];
    }
};

/// Where a tile lies.
struct Place {
    int64_t picture, y, x;  ///< of its first output pixel

    Place(const ConvolutionShape& shape, int tile, int64_t index) {
        const int64_t across = (shape.width + tile - 1) / tile;
        const int64_t down = (shape.height + tile - 1) / tile;
        picture = index / across / down;
        y = index / across % down * tile;
        x = index % across * tile;
    }
};

/// The input pixels of each tile -> transformed [points, stride, in_channels].
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
                const int64_t pixel = (place.picture * shape.height + row) * shape.width + column;
                pixels[i * side + j] = inside ? x + pixel * channels : nullptr;
            }
        }
        for (int64_t c = 0; c < channels; c += lanes) {
            __m512 d[points], half[points];
#pragma GCC unroll 36
            for (int i = 0; i < points; ++i)
                d[i] = pixels[i] ? load(pixels[i] + c) : _mm512_setzero_ps();
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

/// sums [points, stride, columns] -> output pixels of the tiles, in the column from `channel` on.
template <typename Number>
void transform_sums(const ConvolutionShape& shape, const float* sums, const float* bias,
                    int64_t first, int64_t last, int64_t stride, int64_t channel, Number* y) {
    constexpr int tile = winograd_tile<Number>, side = tile + 2, points = side * side;
    for (int64_t t = first; t < last; ++t) {
        const Place place(shape, tile, t);
        for (int c = 0; c < packed_columns; c += lanes) {
            __m512 s[points], half[tile * side], pixels[tile * tile];
#pragma GCC unroll 36
            for (int i = 0; i < points; ++i)
                s[i] = _mm512_loadu_ps(sums + (i * stride + t - first) * packed_columns + c);
#pragma GCC unroll 6
            for (int j = 0; j < side; ++j)
                Transform<tile>::sums(s + j, side, half + j, side);
#pragma GCC unroll 4
            for (int i = 0; i < tile; ++i)
                Transform<tile>::sums(half + i * side, 1, pixels + i * tile, 1);
            const __m512 add = bias ? _mm512_loadu_ps(bias + channel + c) : _mm512_setzero_ps();
#pragma GCC unroll 4
            for (int i = 0; i < tile; ++i)
#pragma GCC unroll 4
                for (int j = 0; j < tile; ++j) {
                    const int64_t row = place.y + i, column = place.x + j;
                    if (row >= shape.height || column >= shape.width) continue;
                    const int64_t pixel =
                        (place.picture * shape.height + row) * shape.width + column;
                    store(y + pixel * shape.out_channels + channel + c, pixels[i * tile + j] + add);
                }
        }
    }
}

}  // namespace

template <typename Number>
void pack_winograd_weights(const Number* weights, int64_t out_channels, int64_t in_channels,
                           int64_t column, Number* packed) {
    using Maths = avx512::Arithmetic<Number>;
    constexpr int tile = winograd_tile<Number>, side = tile + 2, points = side * side;
    for (int64_t c = 0; c < in_channels; c += lanes) {
        for (int64_t o = 0; o < packed_columns; ++o) {
            __m512 g[9], half[3 * side], u[points];
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
            Number* to = packed + column * in_channels + c * packed_columns + o * Maths::group;
#pragma GCC unroll 36
            for (int i = 0; i < points; ++i)
                Maths::scatter(to + i * out_channels * in_channels, u[i]);
        }
    }
}

namespace {

/// Rows that `tiles` tiles are filled up to, and multiplied so many at a time.
template <typename Number>
int64_t rows_for(int64_t tiles) {
    if (std::is_same_v<Number, BrainFloat> && matrix_units_run()) return units::whole_rows(tiles);
    return avx512::whole_rows(tiles);
}

/// sums [count, 64] = a [count, depth] times b, for a count of rows_for(); next: units::multiply().
template <typename Number>
void multiply_rows(const Number* a, int64_t count, int64_t depth, const Number* b,
                   [[maybe_unused]] const Number* next, float* sums) {
    if constexpr (std::is_same_v<Number, BrainFloat>)
        if (matrix_units_run()) {
            const units::Tiles tiles;
            const auto tile = [&](int64_t i) { return a + i * units::tile_rows * depth; };
            return units::multiply(tile, count, depth, b, next, sums, false);
        }
    for (int64_t r = 0; r < count; r += rows) {
        const Number* at[rows];
        for (int j = 0; j < rows; ++j)
            at[j] = a + (r + j) * depth;
        avx512::multiply<Number, 4>(at, depth, b, sums + r * packed_columns, packed_columns, false);
    }
}

}  // namespace

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
    // The last rows may stay as they were: what comes of them is not looked at.
    const int64_t stride = rows_for<Number>(last - first);
    auto* transformed = static_cast<Number*>(scratch);
    auto* sums = reinterpret_cast<float*>(transformed + points * stride * channels);
    transform_input(shape, x, first, last, stride, transformed);
    const auto panel = [&](int64_t channel, int64_t point) {
        return packed + (point * shape.out_channels + channel) * channels;
    };
    for (int64_t channel = part.first_channel; channel < part.last_channel;
         channel += packed_columns) {
        for (int64_t i = 0; i < points; ++i) {
            const bool ends = i + 1 == points,
                       ends_all = channel + packed_columns == part.last_channel;
            const Number* next = !ends      ? panel(channel, i + 1)
                                 : ends_all ? panel(part.first_channel, 0)
                                            : panel(channel + packed_columns, 0);
            multiply_rows(transformed + i * stride * channels, stride, channels, panel(channel, i),
                          next, sums + i * stride * packed_columns);
        }
        transform_sums(shape, sums, bias, first, last, stride, channel, y);
    }
}

#else

template <typename Number>
void pack_winograd_weights(const Number*, std::int64_t, std::int64_t, std::int64_t, Number*) {}

template <typename Number>
std::int64_t winograd_scratch(std::int64_t, std::int64_t) {
    return 0;
}

template <typename Number>
void convolve_winograd(const ConvolutionShape&, const Number*, const Number*, const float*, Number*,
                       const WinogradPart&, void*) {}

#endif

#define ITEM3D_INSTANTIATE(Number)                                                               \
    template void pack_winograd_weights(const Number*, std::int64_t, std::int64_t, std::int64_t, \
                                        Number*);                                                \
    template std::int64_t winograd_scratch<Number>(std::int64_t, std::int64_t);                  \
    template void convolve_winograd(const ConvolutionShape&, const Number*, const Number*,       \
                                    const float*, Number*, const WinogradPart&, void*);
ITEM3D_INSTANTIATE(float)
ITEM3D_INSTANTIATE(BrainFloat)
#undef ITEM3D_INSTANTIATE

}  // namespace item3d
