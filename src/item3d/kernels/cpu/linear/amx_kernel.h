// The convolutions of direct_kernel.h on AMX, whose tiles are rows at equal distances. Maps are
// therefore stored three times: each pixel's place holds its left neighbour, the pixel itself, and
// its right neighbour. Requires amx_available().
//
//     y[p] = sum_t shifted[t % 3][p + (t / 3 - 1) width] weights[t]      t: tap, row by row
//
// The sixteen pixels of a tile are then adjacent for every tap, also where a row of the image ends:
// the shift has put a zero there, and rows of zeros lie above and below.
//
//     shifted  [3, images, height + 2, width, in]           packed  [9, out / 64, in / 2, 64, 2]
//
//     row 0             0 0 0 0 0        of map 0 (left)    rows 1..height:   0 x0 x1 x2 x3
//     rows 1..height    pixels           of map 1                             x0 x1 x2 x3 x4
//     row height + 1    0 0 0 0 0        of map 2 (right)                     x1 x2 x3 x4 0
#pragma once

#include "item3d/kernels/cpu/dispatch.h"
#include "item3d/kernels/cpu/linear/matrix_kernel.h"

namespace item3d {

/// Returns the number of tiles, each of sixteen pixels of one image.
inline std::int64_t unit_tiles(const ConvolutionShape& shape) {
    constexpr std::int64_t pixels = 16;
    return shape.images * ((shape.height * shape.width + pixels - 1) / pixels);
}

/// A range of tiles over all images, and of output channels in whole blocks of 64.
struct TilePart {
    std::int64_t first_tile, last_tile, first_channel, last_channel;
};

#ifdef ITEM3D_HAS_VECTOR_KERNELS
/// Returns the bytes of scratch memory (64-byte aligned) for a part of `tiles` tiles.
std::int64_t unit_taps_scratch(std::int64_t tiles);

/// y = conv(x, weights) + bias, for one part. shifted: [3, images, height + 2, width, in], zero
/// where there is no neighbour and in the first and last rows, followed by sixteen arbitrary
/// pixels. in and out are multiples of 64.
void convolve_taps_amx(const ConvolutionShape& shape, const BFloat16* shifted,
                       const BFloat16* packed, const float* bias, BFloat16* y, const TilePart& part,
                       void* scratch);
#else
inline std::int64_t unit_taps_scratch(std::int64_t) {
    return 0;
}
inline void convolve_taps_amx(const ConvolutionShape&, const BFloat16*, const BFloat16*,
                              const float*, BFloat16*, const TilePart&, void*) {}
#endif

}  // namespace item3d
