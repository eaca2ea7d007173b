// The convolutions of direct_kernel.h on AMX. The rows of an AMX tile lie at equal distances in
// memory. Maps are therefore stored three times. The place of a pixel has its left neighbour in the
// first map, the pixel itself in the second, and its right neighbour in the third. May be called
// only if amx_available().
//
//     y[p] = sum_t shifted[t % 3][p + (t / 3 - 1) width] weights[t]      t: tap, row by row
//
// The sixteen pixels of a tile are then adjacent for every tap. Where a row of the image ends, the
// shift has put a zero; above and below the image lie rows of zeros.
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
/// Returns the number of bytes of scratch memory, which must be aligned to 64 bytes, for a part of
/// `tiles` tiles.
std::int64_t unit_taps_scratch(std::int64_t tiles);

/// Computes y = conv(x, weights) + bias for one part. shifted: [3, images, height + 2, width, in],
/// three copies of x, shifted by -1, 0 and 1 pixels along the width, with zeros where the shift
/// leaves the image and in the first and last row of each image. Sixteen pixels of any value
/// follow. The numbers of input and output channels are multiples of 64.
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
