// Kernels over arrays without a shape: filling, copying, adding, sums of rows, and searches for
// invalid values. They are for the memory of devices; on the CPU, the library's functions do most
// of this.
#pragma once

#include "item3d/core/host_device.h"

#include <bit>
#include <cstdint>

namespace item3d::kernels {

struct ValueParameters {
    const float* in;
    float* out;
    float value;
};

ITEM3D_HOST_DEVICE inline void fill_value(const ValueParameters& p, std::int64_t i) {
    p.out[i] = p.value;
}
ITEM3D_HOST_DEVICE inline void add_value(const ValueParameters& p, std::int64_t i) {
    p.out[i] += p.in[i];
}
/// Negates the second of each four values, as of positions (x, y, z, w). `in` and `out` may be the
/// same array.
ITEM3D_HOST_DEVICE inline void negate_second_of_four(const ValueParameters& p, std::int64_t i) {
    p.out[i] = i % 4 == 1 ? -p.in[i] : p.in[i];
}

/// Copies words of four bytes, whatever they mean.
struct CopyParameters {
    const std::uint32_t* in;
    std::uint32_t* out;
};
ITEM3D_HOST_DEVICE inline void copy_word(const CopyParameters& p, std::int64_t i) {
    p.out[i] = p.in[i];
}

/// Parameters of sums of rows [count, columns], in two passes: sum_rows_of_piece() for
/// [pieces, columns], then sum_pieces() for [columns].
struct RowSumParameters {
    const float* rows;
    std::int64_t count;
    std::int64_t columns;
    std::int64_t pieces;
    double* piece_sums;  ///< [pieces, columns]
    float* sums;         ///< [columns]
};
ITEM3D_HOST_DEVICE inline void sum_rows_of_piece(const RowSumParameters& p, std::int64_t i) {
    const std::int64_t piece = i / p.columns, column = i % p.columns;
    const std::int64_t end = p.count * (piece + 1) / p.pieces;
    double sum = 0;
    for (std::int64_t row = p.count * piece / p.pieces; row < end; ++row)
        sum += p.rows[row * p.columns + column];
    p.piece_sums[i] = sum;
}
ITEM3D_HOST_DEVICE inline void sum_pieces(const RowSumParameters& p, std::int64_t column) {
    double sum = 0;
    for (std::int64_t piece = 0; piece < p.pieces; ++piece)
        sum += p.piece_sums[piece * p.columns + column];
    p.sums[column] = static_cast<float>(sum);
}

/// Parameters of a search for the first invalid value.
struct SearchParameters {
    const float* values;
    const std::int32_t* indices;
    std::int64_t limit;  ///< valid indices are in [0, limit), or in [-1, limit) for neighbours
    /// Complement (~) of the index of the first invalid value. It is 0 initially and if all values
    /// are valid.
    unsigned long long* found;
};

ITEM3D_HOST_DEVICE inline bool is_not_finite(float value) {
    return (std::bit_cast<std::uint32_t>(value) & 0x7f800000u) == 0x7f800000u;
}
ITEM3D_HOST_DEVICE inline bool is_invalid_index(const SearchParameters& p, std::int64_t i) {
    return p.indices[i] < 0 || p.indices[i] >= p.limit;
}
ITEM3D_HOST_DEVICE inline bool is_invalid_neighbour(const SearchParameters& p, std::int64_t i) {
    return p.indices[i] < -1 || p.indices[i] >= p.limit;
}
/// values: a raster [.., 4] (pixel_raster.h). limit: number of triangles.
ITEM3D_HOST_DEVICE inline bool is_invalid_triangle(const SearchParameters& p, std::int64_t pixel) {
    return p.values[4 * pixel + 3] > static_cast<float>(p.limit);
}

/// Records index i if its value is invalid.
ITEM3D_HOST_DEVICE inline void record_invalid(const SearchParameters& p, std::int64_t i,
                                              bool is_invalid) {
    if (!is_invalid) return;
    const auto complement = ~static_cast<unsigned long long>(i);
#if defined(__CUDA_ARCH__)
    atomicMax(p.found, complement);
#else
    if (complement > *p.found) *p.found = complement;
#endif
}

}  // namespace item3d::kernels
