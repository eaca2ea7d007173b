// The matrix product of this folder's kernels. It multiplies a few rows by a packed matrix and
// keeps the sums in registers. Only for files that are compiled for each instruction set.
//
//     sums[i][j] = sum_k a[i][k] b[k][j]        i < 6, j < 64, as outer products of k:
//
//                b[k]   |  0..15 | 16..31 | 32..47 | 48..63 |     registers of one k (group)
//     a[0][k] in all    |  sum   |  sum   |  sum   |  sum   |
//     lanes             |   ..   |   ..   |   ..   |   ..   |     24 registers of sums
//     a[5][k]           |  sum   |  sum   |  sum   |  sum   |
//
// With AVX-512, 29 of the 32 registers are in use: 24 for sums, 4 for b and 1 for a. With AVX2,
// sixteen lanes are two registers, and only sixteen columns are computed at a time. Then 15 of the
// 16 registers are in use: 12 for sums, 2 for b and 1 for a.
//
//     a  rows by pointers, each `depth` adjacent numbers
//     b  [depth / group, columns, group]      group: 2 for BFloat16 (VDPBF16PS adds pairs), else 1
//
// For each k, a row of `columns` * group adjacent numbers of b is read, so that b is read once and
// in order.
#pragma once

#include "item3d/kernels/cpu/linear/matrix_kernel.h"
#include "item3d/kernels/cpu/simd.h"

#include <immintrin.h>

#include <cstdint>

namespace item3d::ITEM3D_INSTRUCTIONS {

/// Number of rows multiplied at a time. Their sums stay in registers, which are 24 of 32 with
/// AVX-512 and 12 of 16 with AVX2.
constexpr int rows = 6;

inline std::int64_t whole_rows(std::int64_t count) {
    return (count + rows - 1) / rows * rows;
}

// Operations that depend on the weights' type. One instruction multiplies a `group` of input
// channels.
template <typename Weight>
struct Arithmetic;

#ifdef __AVX512F__
template <>
struct Arithmetic<BFloat16> {
    static constexpr int group = 2;
    static __m512i broadcast(const BFloat16* from) {
        int pair;
        __builtin_memcpy(&pair, from, sizeof pair);
        return _mm512_set1_epi32(pair);
    }
    static __m512i operand(const BFloat16* from) { return _mm512_loadu_si512(from); }
    static __m512 multiply_add(__m512i a, __m512i b, __m512 sum) {
        return _mm512_dpbf16_ps(sum, reinterpret_cast<__m512bh>(a), reinterpret_cast<__m512bh>(b));
    }
    /// Stores sixteen input channels of one output channel as pairs, which lie `columns` pairs
    /// apart.
    static void scatter(BFloat16* to, int columns, Lanes value) {
        const __m256i places = _mm256_mullo_epi32(_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7),
                                                  _mm256_set1_epi32(columns));
        _mm256_i32scatter_epi32(to, places, narrow(value), 4);
    }
};
#endif

template <>
struct Arithmetic<float> {
    static constexpr int group = 1;
    static Lanes broadcast(const float* from) { return all(*from); }
    static Lanes operand(const float* from) { return load(from); }
    static Lanes multiply_add(Lanes a, Lanes b, Lanes sum) {
        return ITEM3D_INSTRUCTIONS::multiply_add(a, b, sum);
    }
    static void scatter(float* to, int columns, Lanes value) {
        ITEM3D_INSTRUCTIONS::scatter(to, columns, value);
    }
};

/// Weights in fp16 are multiplied as floats. This loses nothing and needs half the memory traffic
/// of float weights.
template <>
struct Arithmetic<Float16> : Arithmetic<float> {
    static Lanes operand(const Float16* from) { return load(from); }
    static void scatter(Float16* to, int columns, Lanes value) {
        Float16 numbers[lanes];
        store(numbers, value);
        for (int i = 0; i < lanes; ++i)
            to[i * columns] = numbers[i];
    }
};

/// Computes the product of a [rows, depth], given by pointers to its rows, and the first columns of
/// b [depth / group, columns, group]. Writes it to sums [rows, 16 * registers], or adds it to them
/// if `add`. Each row of the sums begins `stride` numbers after the previous one.
template <typename Weight, int registers>
void multiply_registers(const Multiplied<Weight>* const* a, std::int64_t depth, const Weight* b,
                        std::int64_t columns, float* sums, std::int64_t stride, bool add) {
    using Maths = Arithmetic<Weight>;
    using Number = Multiplied<Weight>;
    static_assert(rows == 6);
    const Number *a0 = a[0], *a1 = a[1], *a2 = a[2], *a3 = a[3], *a4 = a[4], *a5 = a[5];
    Lanes sum[rows][registers];
#pragma GCC unroll 6
    for (int i = 0; i < rows; ++i)
#pragma GCC unroll 4
        for (int j = 0; j < registers; ++j)
            sum[i][j] = add ? load(sums + i * stride + j * lanes) : zero();
    for (std::int64_t k = 0; k < depth; k += Maths::group) {
        decltype(Maths::operand(b)) operands[registers];
#pragma GCC unroll 4
        for (int j = 0; j < registers; ++j)
            operands[j] = Maths::operand(b + k * columns + j * Maths::group * lanes);
        const Number* const at[rows] = {a0 + k, a1 + k, a2 + k, a3 + k, a4 + k, a5 + k};
#pragma GCC unroll 6
        for (int i = 0; i < rows; ++i) {
            const auto factor = Maths::broadcast(at[i]);
#pragma GCC unroll 4
            for (int j = 0; j < registers; ++j)
                sum[i][j] = Maths::multiply_add(factor, operands[j], sum[i][j]);
        }
    }
#pragma GCC unroll 6
    for (int i = 0; i < rows; ++i)
#pragma GCC unroll 4
        for (int j = 0; j < registers; ++j)
            store(sums + i * stride + j * lanes, sum[i][j]);
}

/// Does the same for all columns of b. Their number is a multiple of 16 and at most packed_columns.
template <typename Weight>
void multiply(std::int64_t columns, const Multiplied<Weight>* const* a, std::int64_t depth,
              const Weight* b, float* sums, std::int64_t stride, bool add) {
#ifdef __AVX512F__
    switch (columns / lanes) {
        case 1:
            return multiply_registers<Weight, 1>(a, depth, b, 1 * lanes, sums, stride, add);
        case 2:
            return multiply_registers<Weight, 2>(a, depth, b, 2 * lanes, sums, stride, add);
        case 3:
            return multiply_registers<Weight, 3>(a, depth, b, 3 * lanes, sums, stride, add);
        default:
            return multiply_registers<Weight, 4>(a, depth, b, 4 * lanes, sums, stride, add);
    }
#else
    constexpr int group = Arithmetic<Weight>::group;
    for (std::int64_t first = 0; first < columns; first += lanes)
        multiply_registers<Weight, 1>(a, depth, b + first * group, columns, sums + first, stride,
                                      add);
#endif
}

}  // namespace item3d::ITEM3D_INSTRUCTIONS
