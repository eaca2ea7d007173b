// Matrix products in bfloat16 on AMX, whose tiles have 16 rows of 64 bytes. Only for files that are
// compiled for AMX. May be called only if amx_available().
//
// One instruction (TDPBF16PS) adds, for 16 rows m, 16 columns n and 16 pairs k,
//
//     sums[m][n] += a[m][2k] b[k][n][0] + a[m][2k + 1] b[k][n][1]
//
// Two tiles of a times two tiles of b fill four tiles of sums, so that each loaded tile is used
// twice:
//
//                      b, columns 0..15   16..31
//                          tile 6         tile 7        a tile of a: 16 rows x 32 numbers
//     a, rows  0..15       tile 0         tile 1        a tile of b: 16 pairs x 16 columns x 2
//     tile 4
//     a, rows 16..31       tile 2         tile 3        a tile of sums: 16 rows x 16 floats
//     tile 5
//
//     a     [count, depth]              row after row, rows `depth` numbers apart
//     b     [depth / 2, 64, 2]          matrix_tile.h's packing, 256 bytes a pair of depths
//     sums  [count, 64]                 256 bytes a row
#pragma once

#include "item3d/kernels/cpu/bfloat16.h"
#include "item3d/kernels/cpu/linear/matrix_kernel.h"

#include <immintrin.h>

#include <cstdint>

namespace item3d::units {

/// Number of rows in a tile, and number of rows multiplied at a time (two tiles).
constexpr int tile_rows = 16, rows = 2 * tile_rows;

inline std::int64_t whole_rows(std::int64_t count) {
    return (count + rows - 1) / rows * rows;
}

/// RAII configuration of this thread's tiles, all of which have their full size.
class Tiles {
  public:
    Tiles() {
        struct alignas(64) Layout {
            std::uint8_t palette = 1, start_row = 0, reserved[14] = {};
            std::uint16_t row_bytes[16] = {64, 64, 64, 64, 64, 64, 64, 64};
            std::uint8_t rows[16] = {16, 16, 16, 16, 16, 16, 16, 16};
        };
        static_assert(sizeof(Layout) == 64);
        const Layout layout;
        _tile_loadconfig(&layout);
    }
    ~Tiles() { _tile_release(); }
    Tiles(const Tiles&) = delete;
    Tiles& operator=(const Tiles&) = delete;
};

/// Computes the product of a [count, depth] and b [depth / 2, 64, 2], and writes it to sums [count,
/// 64], or adds it to them if `add`. count is a multiple of `rows`, and depth is a multiple of 32.
/// tile_at(i) returns the first of the sixteen rows of a's tile i; each row begins `depth` numbers
/// after the previous one. next: b of the following call. It is prefetched, because processors do
/// not predict tile loads, and waiting for the loads takes as long as multiplying
/// (docs/journal/benchmarks.md). The prefetches are spread evenly over the steps.
template <typename TileAt>
void multiply(const TileAt& tile_at, std::int64_t count, std::int64_t depth, const BFloat16* b,
              const BFloat16* next, float* sums, bool add) {
    constexpr int half = packed_columns / 2, group = 2, line = 64;
    constexpr int b_stride = packed_columns * group * static_cast<int>(sizeof(BFloat16));
    constexpr int sums_stride = packed_columns * static_cast<int>(sizeof(float));
    const auto a_stride = depth * static_cast<std::int64_t>(sizeof(BFloat16));
    const std::int64_t steps = count / rows * (packed_columns / half) * (depth / half);
    const std::int64_t bytes = depth * packed_columns * static_cast<std::int64_t>(sizeof(*b));
    const std::int64_t lines_a_step = (bytes / line + steps - 1) / steps;
    const char* fetched = reinterpret_cast<const char*>(next);
    const char* const fetched_end = fetched + bytes;
    for (std::int64_t row = 0; row < count; row += rows) {
        const BFloat16* const upper = tile_at(row / tile_rows);
        const BFloat16* const lower = tile_at(row / tile_rows + 1);
        for (int column = 0; column < packed_columns; column += half) {
            float* const top = sums + row * packed_columns + column;
            float* const bottom = top + tile_rows * packed_columns;
            if (add) {
                _tile_loadd(0, top, sums_stride);
                _tile_loadd(1, top + tile_rows, sums_stride);
                _tile_loadd(2, bottom, sums_stride);
                _tile_loadd(3, bottom + tile_rows, sums_stride);
            } else {
                _tile_zero(0);
                _tile_zero(1);
                _tile_zero(2);
                _tile_zero(3);
            }
            for (std::int64_t k = 0; k < depth; k += half) {
                for (std::int64_t i = 0; i < lines_a_step && fetched < fetched_end; ++i) {
                    _mm_prefetch(fetched, _MM_HINT_T1);
                    fetched += line;
                }
                const BFloat16* left = b + k * packed_columns + column * group;
                _tile_loadd(4, upper + k, a_stride);
                _tile_loadd(6, left, b_stride);
                _tile_dpbf16ps(0, 4, 6);
                _tile_loadd(7, left + tile_rows * group, b_stride);
                _tile_dpbf16ps(1, 4, 7);
                _tile_loadd(5, lower + k, a_stride);
                _tile_dpbf16ps(2, 5, 6);
                _tile_dpbf16ps(3, 5, 7);
            }
            _tile_stored(0, top, sums_stride);
            _tile_stored(1, top + tile_rows, sums_stride);
            _tile_stored(2, bottom, sums_stride);
            _tile_stored(3, bottom + tile_rows, sums_stride);
        }
    }
}

}  // namespace item3d::units
