// A 3x3 convolution as nine products of AMX tiles (amx.h), one for each tap, summed in scratch
// memory.
//
//     for each 64 output channels
//         for each tap: sums [tiles * 16, 64] (+)= shifted rows of the tap * panel of the tap
//         y = sums + bias
//
// Tile i of an image has its pixels 16 i .. 16 i + 15, row after row. The last tile may read past
// the image into the memory that follows, which is the next rows of zeros, or the sixteen spare
// pixels at the end. The rows of the result beyond the image are computed but not stored. Tiles are
// multiplied in pairs. If their number is odd, the last one is multiplied twice.
//
// Scratch memory:   sums  float [tiles * 16 rounded up to 32, 64]
#include "item3d/kernels/cpu/linear/amx_kernel.h"

#ifdef __AMX_BF16__
#include "item3d/kernels/cpu/amx.h"
#include "item3d/kernels/cpu/simd.h"
#endif

#include <algorithm>

namespace item3d {

using std::int64_t;

#ifdef __AMX_BF16__

int64_t unit_taps_scratch(int64_t tiles) {
    return units::whole_rows(tiles * units::tile_rows) * packed_columns *
           static_cast<int64_t>(sizeof(float));
}

void convolve_taps_amx(const ConvolutionShape& shape, const BFloat16* shifted,
                       const BFloat16* packed, const float* bias, BFloat16* y, const TilePart& part,
                       void* scratch) {
    using namespace avx512;
    constexpr int taps = 9;
    const int64_t in = shape.in_channels, out = shape.out_channels;
    const int64_t pixels = shape.height * shape.width, padded = pixels + 2 * shape.width;
    const int64_t tiles_a_image = unit_tiles(shape) / shape.images;
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
                // The last tile is repeated to complete a pair.
                const int64_t at = std::min(part.first_tile + i, part.last_tile - 1);
                const int64_t image = at / tiles_a_image;
                const int64_t pixel = at % tiles_a_image * units::tile_rows;
                const int64_t row =
                    (tap % 3 * shape.images + image) * padded + tap / 3 * shape.width + pixel;
                return shifted + row * in;
            };
            const int64_t next_channel = std::min(channel + packed_columns, out - packed_columns);
            units::multiply(tile, count, in, panel(channel, tap),
                            tap + 1 < taps ? panel(channel, tap + 1) : panel(next_channel, 0), sums,
                            tap > 0);
        }
        for (int64_t r = 0; r < tiles * units::tile_rows; ++r) {
            const int64_t at = part.first_tile + r / units::tile_rows;
            const int64_t pixel = at % tiles_a_image * units::tile_rows + r % units::tile_rows;
            if (pixel >= pixels) continue;
            BFloat16* to = y + (at / tiles_a_image * pixels + pixel) * out + channel;
            for (int64_t c = 0; c < packed_columns; c += lanes) {
                const Lanes add = bias ? load(bias + channel + c) : zero();
                store(to + c, load(sums + r * packed_columns + c) + add);
            }
        }
    }
}

#else

int64_t unit_taps_scratch(int64_t) {
    return 0;
}

void convolve_taps_amx(const ConvolutionShape&, const BFloat16*, const BFloat16*, const float*,
                       BFloat16*, const TilePart&, void*) {}

#endif

}  // namespace item3d
