// The product that the kernels of this folder spend their time in: a few rows times a packed
// matrix, sums in registers. For the files that are compiled for AVX-512 alone.
#pragma once

#include "item3d/models/avx512_numbers.h"
#include "item3d/models/matrix_kernel.h"

#include <immintrin.h>

#include <cstdint>

namespace item3d {

namespace avx512 {

/// Rows multiplied at a time: with four registers of columns each, 24 sums stay in registers.
constexpr int rows = 6;

inline std::int64_t whole_rows(std::int64_t count) {
    return (count + rows - 1) / rows * rows;
}

// What differs between the weights' types. A `group` of input channels is multiplied by one
// instruction.
template <typename Weight>
struct Arithmetic;

template <>
struct Arithmetic<BrainFloat> {
    static constexpr int group = 2;
    static __m512i broadcast(const BrainFloat* from) {
        int pair;
        __builtin_memcpy(&pair, from, sizeof pair);
        return _mm512_set1_epi32(pair);
    }
    static __m512i operand(const BrainFloat* from) { return _mm512_loadu_si512(from); }
    static __m512 multiply_add(__m512i a, __m512i b, __m512 sum) {
        return _mm512_dpbf16_ps(sum, reinterpret_cast<__m512bh>(a), reinterpret_cast<__m512bh>(b));
    }
    /// Sixteen input channels of one output channel, each pair `packed_columns` pairs on.
    static void scatter(BrainFloat* to, __m512 value) {
        const __m256i places =
            _mm256_mullo_epi32(_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7),
                               _mm256_set1_epi32(static_cast<int>(packed_columns)));
        _mm256_i32scatter_epi32(to, places, narrow(value), 4);
    }
};

template <>
struct Arithmetic<float> {
    static constexpr int group = 1;
    static __m512 broadcast(const float* from) { return _mm512_set1_ps(*from); }
    static __m512 operand(const float* from) { return _mm512_loadu_ps(from); }
    static __m512 multiply_add(__m512 a, __m512 b, __m512 sum) {
        return _mm512_fmadd_ps(a, b, sum);
    }
    static void scatter(float* to, __m512 value) {
        const __m512i places = _mm512_mullo_epi32(
            _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15),
            _mm512_set1_epi32(static_cast<int>(packed_columns)));
        _mm512_i32scatter_ps(to, places, value, 4);
    }
};

/// Weights as files have them, multiplied as floats: no bit is lost, and half the memory read.
template <>
struct Arithmetic<HalfFloat> : Arithmetic<float> {
    static __m512 operand(const HalfFloat* from) { return load(from); }
    static void scatter(HalfFloat* to, __m512 value) {
        HalfFloat numbers[lanes];
        store(numbers, value);
        for (int i = 0; i < lanes; ++i)
            to[i * packed_columns] = numbers[i];
    }
};

/// sums [rows, 16 registers], each row `stride` numbers after the one before, = (or +=, with `add`)
/// a [rows, depth], given by its rows, times b [depth / group, 16 registers, group].
template <typename Weight, int registers>
void multiply(const Multiplied<Weight>* const* a, std::int64_t depth, const Weight* b, float* sums,
              std::int64_t stride, bool add) {
    using Maths = Arithmetic<Weight>;
    using Number = Multiplied<Weight>;
    static_assert(rows == 6);
    const Number *a0 = a[0], *a1 = a[1], *a2 = a[2], *a3 = a[3], *a4 = a[4], *a5 = a[5];
    __m512 sum[rows][registers];
#pragma GCC unroll 6
    for (int i = 0; i < rows; ++i)
#pragma GCC unroll 4
        for (int j = 0; j < registers; ++j)
            sum[i][j] = add ? _mm512_loadu_ps(sums + i * stride + j * lanes) : _mm512_setzero_ps();
    for (std::int64_t k = 0; k < depth; k += Maths::group) {
        decltype(Maths::operand(b)) columns[registers];
#pragma GCC unroll 4
        for (int j = 0; j < registers; ++j)
            columns[j] = Maths::operand(b + (k * registers + j * Maths::group) * lanes);
        const Number* const at[rows] = {a0 + k, a1 + k, a2 + k, a3 + k, a4 + k, a5 + k};
#pragma GCC unroll 6
        for (int i = 0; i < rows; ++i) {
            const auto factor = Maths::broadcast(at[i]);
#pragma GCC unroll 4
            for (int j = 0; j < registers; ++j)
                sum[i][j] = Maths::multiply_add(factor, columns[j], sum[i][j]);
        }
    }
#pragma GCC unroll 6
    for (int i = 0; i < rows; ++i)
#pragma GCC unroll 4
        for (int j = 0; j < registers; ++j)
            _mm512_storeu_ps(sums + i * stride + j * lanes, sum[i][j]);
}

/// The same for 1 to 4 registers, told at run time.
template <typename Weight>
void multiply(std::int64_t registers, const Multiplied<Weight>* const* a, std::int64_t depth,
              const Weight* b, float* sums, std::int64_t stride, bool add) {
    switch (registers) {
        case 1:
            return multiply<Weight, 1>(a, depth, b, sums, stride, add);
        case 2:
            return multiply<Weight, 2>(a, depth, b, sums, stride, add);
        case 3:
            return multiply<Weight, 3>(a, depth, b, sums, stride, add);
        default:
            return multiply<Weight, 4>(a, depth, b, sums, stride, add);
    }
}

}  // namespace avx512
}  // namespace item3d
