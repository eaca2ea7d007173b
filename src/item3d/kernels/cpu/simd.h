// SIMD operations on sixteen floats, and loads and stores of float, BFloat16 and Float16. They use
// the instruction set for which a file is compiled. Files that include this header are compiled
// once for each set (src/CMakeLists.txt), each time with their definitions in another namespace,
// ITEM3D_INSTRUCTIONS.
#pragma once

#include "item3d/kernels/cpu/bfloat16.h"
#include "item3d/kernels/cpu/dispatch.h"

#include <immintrin.h>

#include <cstdint>
#include <cstring>
#include <initializer_list>

namespace item3d::ITEM3D_INSTRUCTIONS {

/// Number of floats in a register, or in a pair that is used as one.
constexpr int lanes = 16;
static_assert(lanes == register_numbers);

#ifdef __AVX512F__

using Lanes = __m512;
using Mask = __mmask16;  ///< one bit for each lane

inline Lanes zero() {
    return _mm512_setzero_ps();
}

inline Lanes all(float value) {
    return _mm512_set1_ps(value);
}

/// Returns a b + c, rounded once.
inline Lanes multiply_add(Lanes a, Lanes b, Lanes c) {
    return _mm512_fmadd_ps(a, b, c);
}

/// Returns a b - c, rounded once.
inline Lanes multiply_subtract(Lanes a, Lanes b, Lanes c) {
    return _mm512_fmsub_ps(a, b, c);
}

/// Returns c - a b, rounded once.
inline Lanes subtract_product(Lanes c, Lanes a, Lanes b) {
    return _mm512_fnmadd_ps(a, b, c);
}

inline Lanes smaller(Lanes a, Lanes b) {
    return _mm512_min_ps(a, b);
}

inline Lanes larger(Lanes a, Lanes b) {
    return _mm512_max_ps(a, b);
}

inline Lanes absolute(Lanes x) {
    return _mm512_abs_ps(x);
}

/// Rounds to the nearest integer.
inline Lanes nearest(Lanes x) {
    return _mm512_roundscale_ps(x, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}

/// Returns x 2^n for integral n; 0 on underflow.
inline Lanes scaled(Lanes x, Lanes n) {
    return _mm512_scalef_ps(x, n);
}

inline Mask is_less(Lanes a, Lanes b) {
    return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ);
}

inline Lanes choose(Mask which, Lanes there, Lanes elsewhere) {
    return _mm512_mask_mov_ps(elsewhere, which, there);
}

inline float largest(Lanes x) {
    return _mm512_reduce_max_ps(x);
}

inline float sum_of(Lanes x) {
    return _mm512_reduce_add_ps(x);
}

/// Returns a mask of the first `count` lanes, or of all if `count` is larger.
inline Mask first_lanes(std::int64_t count) {
    return static_cast<Mask>(count >= lanes ? 0xffff : (1 << count) - 1);
}

inline Lanes load(const float* from) {
    return _mm512_loadu_ps(from);
}

/// Loads `count` numbers, but at most sixteen, into the first lanes, and 0 into the others. Reads
/// nothing beyond these numbers.
inline Lanes load_first(const float* from, std::int64_t count) {
    return _mm512_maskz_loadu_ps(first_lanes(count), from);
}

inline void store(float* to, Lanes value) {
    _mm512_storeu_ps(to, value);
}

/// Stores the first `count` lanes, or all if `count` is larger. Writes nothing beyond them.
inline void store_first(float* to, std::int64_t count, Lanes value) {
    _mm512_mask_storeu_ps(to, first_lanes(count), value);
}

inline __m256i narrow(Lanes value) {
    return reinterpret_cast<__m256i>(_mm512_cvtneps_pbh(value));
}

inline Lanes load(const BFloat16* from) {
    const __m256i bits = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
    return _mm512_castsi512_ps(_mm512_slli_epi32(_mm512_cvtepu16_epi32(bits), 16));
}

inline void store(BFloat16* to, Lanes value) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), narrow(value));
}

inline void store_first(BFloat16* to, std::int64_t count, Lanes value) {
    _mm256_mask_storeu_epi16(to, first_lanes(count), narrow(value));
}

inline Lanes load(const Float16* from) {
    return _mm512_cvtph_ps(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(from)));
}

/// Rounds to nearest. Values that were loaded from Float16 are stored exactly.
inline void store(Float16* to, Lanes value) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                        _mm512_cvtps_ph(value, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
}

/// Adds the lanes to to[0] .. to[lanes - 1].
inline void add_to(double* to, Lanes value) {
    const __m512d low = _mm512_cvtps_pd(_mm512_castps512_ps256(value));
    const __m512d high = _mm512_cvtps_pd(_mm512_extractf32x8_ps(value, 1));
    _mm512_storeu_pd(to, _mm512_loadu_pd(to) + low);
    _mm512_storeu_pd(to + 8, _mm512_loadu_pd(to + 8) + high);
}

/// Stores lane i to to[i step].
inline void scatter(float* to, int step, Lanes value) {
    const __m512i places =
        _mm512_mullo_epi32(_mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15),
                           _mm512_set1_epi32(step));
    _mm512_i32scatter_ps(to, places, value, sizeof(float));
}

/// Loads lane i from from[i step].
inline Lanes gather(const float* from, int step) {
    const __m512i places =
        _mm512_mullo_epi32(_mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15),
                           _mm512_set1_epi32(step));
    return _mm512_i32gather_ps(places, from, sizeof(float));
}

#else

/// The versions for AVX2, FMA and F16C. They can load BFloat16 but not store it, because processors
/// with fast bfloat16 have AVX-512.
struct Lanes {
    __m256 low, high;
};

struct Mask {
    __m256i low, high;
};

inline Lanes operator+(Lanes a, Lanes b) {
    return {a.low + b.low, a.high + b.high};
}

inline Lanes operator-(Lanes a, Lanes b) {
    return {a.low - b.low, a.high - b.high};
}

inline Lanes operator-(Lanes x) {
    return {-x.low, -x.high};
}

inline Lanes operator*(Lanes a, Lanes b) {
    return {a.low * b.low, a.high * b.high};
}

inline Lanes operator/(Lanes a, Lanes b) {
    return {a.low / b.low, a.high / b.high};
}

inline Lanes& operator+=(Lanes& to, Lanes value) {
    return to = to + value;
}

inline Lanes all(float value) {
    return {_mm256_set1_ps(value), _mm256_set1_ps(value)};
}

inline Lanes zero() {
    return all(0);
}

inline Lanes multiply_add(Lanes a, Lanes b, Lanes c) {
    return {_mm256_fmadd_ps(a.low, b.low, c.low), _mm256_fmadd_ps(a.high, b.high, c.high)};
}

inline Lanes multiply_subtract(Lanes a, Lanes b, Lanes c) {
    return {_mm256_fmsub_ps(a.low, b.low, c.low), _mm256_fmsub_ps(a.high, b.high, c.high)};
}

inline Lanes subtract_product(Lanes c, Lanes a, Lanes b) {
    return {_mm256_fnmadd_ps(a.low, b.low, c.low), _mm256_fnmadd_ps(a.high, b.high, c.high)};
}

inline Lanes smaller(Lanes a, Lanes b) {
    return {_mm256_min_ps(a.low, b.low), _mm256_min_ps(a.high, b.high)};
}

inline Lanes larger(Lanes a, Lanes b) {
    return {_mm256_max_ps(a.low, b.low), _mm256_max_ps(a.high, b.high)};
}

inline Lanes absolute(Lanes x) {
    const __m256 sign = _mm256_set1_ps(-0.0f);
    return {_mm256_andnot_ps(sign, x.low), _mm256_andnot_ps(sign, x.high)};
}

inline Lanes nearest(Lanes x) {
    constexpr int way = _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC;
    return {_mm256_round_ps(x.low, way), _mm256_round_ps(x.high, way)};
}

/// Returns x 2^n for integral n. The result is 0 for n <= -127, and at most 2^127 x.
inline Lanes scaled(Lanes x, Lanes n) {
    const Lanes kept = larger(smaller(n, all(127)), all(-127));
    const auto power = [](__m256 of) {
        const __m256i exponent = _mm256_add_epi32(_mm256_cvtps_epi32(of), _mm256_set1_epi32(127));
        return _mm256_castsi256_ps(_mm256_slli_epi32(exponent, 23));
    };
    return {x.low * power(kept.low), x.high * power(kept.high)};
}

inline Mask is_less(Lanes a, Lanes b) {
    return {_mm256_castps_si256(_mm256_cmp_ps(a.low, b.low, _CMP_LT_OQ)),
            _mm256_castps_si256(_mm256_cmp_ps(a.high, b.high, _CMP_LT_OQ))};
}

inline Lanes choose(Mask which, Lanes there, Lanes elsewhere) {
    return {_mm256_blendv_ps(elsewhere.low, there.low, _mm256_castsi256_ps(which.low)),
            _mm256_blendv_ps(elsewhere.high, there.high, _mm256_castsi256_ps(which.high))};
}

inline float largest(Lanes x) {
    const __m256 eight = _mm256_max_ps(x.low, x.high);
    const __m128 four = _mm_max_ps(_mm256_castps256_ps128(eight), _mm256_extractf128_ps(eight, 1));
    const __m128 two = _mm_max_ps(four, _mm_movehl_ps(four, four));
    return _mm_cvtss_f32(_mm_max_ss(two, _mm_movehdup_ps(two)));
}

inline float sum_of(Lanes x) {
    const __m256 eight = x.low + x.high;
    const __m128 four = _mm256_castps256_ps128(eight) + _mm256_extractf128_ps(eight, 1);
    const __m128 two = four + _mm_movehl_ps(four, four);
    return _mm_cvtss_f32(_mm_add_ss(two, _mm_movehdup_ps(two)));
}

inline Mask first_lanes(std::int64_t count) {
    const __m256i limit = _mm256_set1_epi32(count >= lanes ? lanes : static_cast<int>(count));
    return {_mm256_cmpgt_epi32(limit, _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)),
            _mm256_cmpgt_epi32(limit, _mm256_setr_epi32(8, 9, 10, 11, 12, 13, 14, 15))};
}

inline Lanes load(const float* from) {
    return {_mm256_loadu_ps(from), _mm256_loadu_ps(from + 8)};
}

inline Lanes load_first(const float* from, std::int64_t count) {
    if (count >= lanes) return load(from);
    const Mask which = first_lanes(count);
    return {_mm256_maskload_ps(from, which.low), _mm256_maskload_ps(from + 8, which.high)};
}

inline void store(float* to, Lanes value) {
    _mm256_storeu_ps(to, value.low);
    _mm256_storeu_ps(to + 8, value.high);
}

inline void store_first(float* to, std::int64_t count, Lanes value) {
    if (count >= lanes) return store(to, value);
    // The numbers are copied, because masked stores are slow on AMD's processors.
    float numbers[lanes];
    store(numbers, value);
    std::memcpy(to, numbers, static_cast<std::size_t>(count) * sizeof(float));
}

inline Lanes load(const BFloat16* from) {
    const auto* numbers = reinterpret_cast<const __m128i*>(from);
    const auto widen = [](__m128i eight) {
        return _mm256_castsi256_ps(_mm256_slli_epi32(_mm256_cvtepu16_epi32(eight), 16));
    };
    return {widen(_mm_loadu_si128(numbers)), widen(_mm_loadu_si128(numbers + 1))};
}

inline Lanes load(const Float16* from) {
    const auto* halves = reinterpret_cast<const __m128i*>(from);
    return {_mm256_cvtph_ps(_mm_loadu_si128(halves)), _mm256_cvtph_ps(_mm_loadu_si128(halves + 1))};
}

inline void store(Float16* to, Lanes value) {
    constexpr int way = _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC;
    auto* halves = reinterpret_cast<__m128i*>(to);
    _mm_storeu_si128(halves, _mm256_cvtps_ph(value.low, way));
    _mm_storeu_si128(halves + 1, _mm256_cvtps_ph(value.high, way));
}

inline void add_to(double* to, Lanes value) {
    const __m128 quarters[] = {
        _mm256_castps256_ps128(value.low), _mm256_extractf128_ps(value.low, 1),
        _mm256_castps256_ps128(value.high), _mm256_extractf128_ps(value.high, 1)};
    for (const __m128 quarter : quarters) {
        _mm256_storeu_pd(to, _mm256_loadu_pd(to) + _mm256_cvtps_pd(quarter));
        to += 4;
    }
}

inline void scatter(float* to, int step, Lanes value) {
    float numbers[lanes];
    store(numbers, value);
    for (int i = 0; i < lanes; ++i)
        to[i * step] = numbers[i];
}

inline Lanes gather(const float* from, int step) {
    float numbers[lanes];
    for (int i = 0; i < lanes; ++i)
        numbers[i] = from[i * step];
    return load(numbers);
}

#endif

/// Attribute of functions of Lanes. Inlined functions do not pass Lanes through memory.
#define ITEM3D_INLINE [[gnu::always_inline]] inline

/// Returns e^x to the precision of float, as 2^n e^r with |r| <= ln(2) / 2 and e^r by its Taylor
/// series.
ITEM3D_INLINE Lanes exponential(Lanes x) {
    const Lanes n = nearest(x * all(1.44269504f));
    const Lanes high = subtract_product(x, n, all(0.693359375f));
    const Lanes r = subtract_product(high, n, all(-2.12194440e-4f));
    Lanes series = all(1.0f / 5040);
    for (const float term : {1.0f / 720, 1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f})
        series = multiply_add(series, r, all(term));
    return scaled(series, n);
}

}  // namespace item3d::ITEM3D_INSTRUCTIONS
