#include "item3d/models/direct_kernel.h"

#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512VL__) && \
    defined(__AVX512BF16__)
#define ITEM3D_DIRECT 1
#include "item3d/models/matrix_tile.h"
#include "item3d/models/matrix_units.h"
#endif

#include <algorithm>
#include <cstring>

namespace item3d {

using std::int64_t;

#ifdef ITEM3D_DIRECT

namespace {

using avx512::lanes;
using avx512::rows;

constexpr int taps = 9;

/// The pixels under one tap for each of `rows` output pixels from `first` on; `outside` beyond the
/// edge, and after `last`. False where all are outside.
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

}  // namespace

template <typename Weight>
void pack_taps(const Weight* weights, int64_t out_channels, int64_t in_channels, int64_t column,
               Weight* packed) {
    using Maths = avx512::Arithmetic<Weight>;
    for (int tap = 0; tap < taps; ++tap) {
        Weight* to = packed + (tap * out_channels + column) * in_channels;
        for (int64_t o = 0; o < packed_columns; ++o) {
            const Weight* from = weights + (o * taps + tap) * in_channels;
            for (int64_t c = 0; c < in_channels; c += lanes)
                Maths::scatter(to + c * packed_columns + o * Maths::group, avx512::load(from + c));
        }
    }
}

template <typename Number>
int64_t taps_scratch(int64_t pixels, int64_t in_channels) {
    return avx512::whole_rows(pixels) * packed_columns * static_cast<int64_t>(sizeof(float)) +
           in_channels * static_cast<int64_t>(sizeof(Number));
}

template <typename Weight>
void convolve_taps(const ConvolutionShape& shape, const Multiplied<Weight>* x, const Weight* packed,
                   const float* bias, Multiplied<Weight>* y, const PixelPart& part, void* scratch) {
    using Number = Multiplied<Weight>;
    const int64_t in = shape.in_channels, out = shape.out_channels;
    const int64_t pixels = part.last_pixel - part.first_pixel;
    auto* sums = static_cast<float*>(scratch);
    auto* outside = reinterpret_cast<Number*>(sums + avx512::whole_rows(pixels) * packed_columns);
    std::memset(outside, 0, static_cast<std::size_t>(in) * sizeof(Number));
    for (int64_t channel = part.first_channel; channel < part.last_channel;
         channel += packed_columns) {
        std::memset(
            sums, 0,
            static_cast<std::size_t>(avx512::whole_rows(pixels) * packed_columns) * sizeof(float));
        for (int tap = 0; tap < taps; ++tap) {
            const Weight* b = packed + (tap * out + channel) * in;
            for (int64_t r = 0; r < pixels; r += rows) {
                const Number* a[rows];
                if (find_pixels(shape, x, outside, tap, part.first_pixel + r, part.last_pixel, a))
                    avx512::multiply<Weight, 4>(a, in, b, sums + r * packed_columns, packed_columns,
                                                true);
            }
        }
        for (int64_t r = 0; r < pixels; ++r) {
            for (int64_t c = 0; c < packed_columns; c += lanes) {
                const __m512 add = bias ? avx512::load(bias + channel + c) : _mm512_setzero_ps();
                avx512::store(y + (part.first_pixel + r) * out + channel + c,
                              avx512::load(sums + r * packed_columns + c) + add);
            }
        }
    }
}

int64_t unit_taps_scratch(int64_t tiles) {
    return units::whole_rows(tiles * units::tile_rows) * packed_columns *
           static_cast<int64_t>(sizeof(float));
}

void convolve_taps_in_units(const ConvolutionShape& shape, const BrainFloat* shifted,
                            const BrainFloat* packed, const float* bias, BrainFloat* y,
                            const TilePart& part, void* scratch) {
    const int64_t in = shape.in_channels, out = shape.out_channels;
    const int64_t pixels = shape.height * shape.width, padded = pixels + 2 * shape.width;
    const int64_t tiles_a_picture = unit_tiles(shape) / shape.pictures;
    const int64_t tiles = part.last_tile - part.first_tile;
    const int64_t count = units::whole_rows(tiles * units::tile_rows);
    auto* sums = static_cast<float*>(scratch);
    const units::Tiles all_of_full_size;
    const auto panel = [&](int64_t channel, int tap) {
        return packed + (tap * out + channel) * in;
    };
    for (int64_t channel = part.first_channel; channel < part.last_channel;
         channel += packed_columns) {
        for (int tap = 0; tap < taps; ++tap) {
            const auto tile = [&](int64_t i) {
                // The last tile again where there is none to fill a pair.
                const int64_t at = std::min(part.first_tile + i, part.last_tile - 1);
                const int64_t picture = at / tiles_a_picture;
                const int64_t pixel = at % tiles_a_picture * units::tile_rows;
                const int64_t row =
                    (tap % 3 * shape.pictures + picture) * padded + tap / 3 * shape.width + pixel;
                return shifted + row * in;
            };
            const int64_t next_channel = std::min(channel + packed_columns, out - packed_columns);
            units::multiply(tile, count, in, panel(channel, tap),
                            tap + 1 < taps ? panel(channel, tap + 1) : panel(next_channel, 0), sums,
                            tap > 0);
        }
        for (int64_t r = 0; r < tiles * units::tile_rows; ++r) {
            const int64_t at = part.first_tile + r / units::tile_rows;
            const int64_t pixel = at % tiles_a_picture * units::tile_rows + r % units::tile_rows;
            if (pixel >= pixels) continue;
            BrainFloat* to = y + (at / tiles_a_picture * pixels + pixel) * out + channel;
            for (int64_t c = 0; c < packed_columns; c += lanes) {
                const __m512 add = bias ? avx512::load(bias + channel + c) : _mm512_setzero_ps();
                avx512::store(to + c, avx512::load(sums + r * packed_columns + c) + add);
            }
        }
    }
}

#else

template <typename Weight>
void pack_taps(const Weight*, int64_t, int64_t, int64_t, Weight*) {}

template <typename Number>
int64_t taps_scratch(int64_t, int64_t) {
    return 0;
}

template <typename Weight>
void convolve_taps(const ConvolutionShape&, const Multiplied<Weight>*, const Weight*, const float*,
                   Multiplied<Weight>*, const PixelPart&, void*) {}

int64_t unit_taps_scratch(int64_t) {
    return 0;
}

void convolve_taps_in_units(const ConvolutionShape&, const BrainFloat*, const BrainFloat*,
                            const float*, BrainFloat*, const TilePart&, void*) {}

#endif

template int64_t taps_scratch<float>(int64_t, int64_t);
template int64_t taps_scratch<BrainFloat>(int64_t, int64_t);
#define ITEM3D_INSTANTIATE(Weight)                                                                 \
    template void pack_taps(const Weight*, int64_t, int64_t, int64_t, Weight*);                    \
    template void convolve_taps(const ConvolutionShape&, const Multiplied<Weight>*, const Weight*, \
                                const float*, Multiplied<Weight>*, const PixelPart&, void*);
ITEM3D_INSTANTIATE(float)
ITEM3D_INSTANTIATE(BrainFloat)
ITEM3D_INSTANTIATE(HalfFloat)
#undef ITEM3D_INSTANTIATE

}  // namespace item3d
