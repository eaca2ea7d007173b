// float, BrainFloat and HalfFloat in registers of sixteen, for the files that are compiled for
// AVX-512 alone.
#pragma once

#include "item3d/models/brain_float.h"

#include <immintrin.h>

#include <cstdint>
#include <initializer_list>

namespace item3d::avx512 {

/// Numbers of a register.
constexpr int lanes = 16;

/// The first `count` lanes of a register, or all.
inline __mmask16 first_lanes(std::int64_t count) {
    return static_cast<__mmask16>(count >= lanes ? 0xffff : (1 << count) - 1);
}

inline __m512 load(const float* from) {
    return _mm512_loadu_ps(from);
}

inline void store(float* to, __m512 value) {
    _mm512_storeu_ps(to, value);
}

inline __m256i narrow(__m512 value) {
    return reinterpret_cast<__m256i>(_mm512_cvtneps_pbh(value));
}

inline __m512 load(const BrainFloat* from) {
    const __m256i bits = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
    return _mm512_castsi512_ps(_mm512_slli_epi32(_mm512_cvtepu16_epi32(bits), 16));
}

inline __m512 load(const HalfFloat* from) {
    return _mm512_cvtph_ps(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(from)));
}

inline void store(BrainFloat* to, __m512 value) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), narrow(value));
}

/// To the nearest; exact for numbers that were HalfFloat.
inline void store(HalfFloat* to, __m512 value) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                        _mm512_cvtps_ph(value, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC));
}

inline void store_some(float* to, __mmask16 which, __m512 value) {
    _mm512_mask_storeu_ps(to, which, value);
}

inline void store_some(BrainFloat* to, __mmask16 which, __m512 value) {
    _mm256_mask_storeu_epi16(to, which, narrow(value));
}

/// e^x to float's precision: 2^n e^r with |r| <= ln(2) / 2, e^r by its Taylor series.
inline __m512 exponential(__m512 x) {
    const __m512 n = _mm512_roundscale_ps(x * _mm512_set1_ps(1.44269504f),
                                          _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
    const __m512 high = _mm512_fnmadd_ps(n, _mm512_set1_ps(0.693359375f), x);
    const __m512 r = _mm512_fnmadd_ps(n, _mm512_set1_ps(-2.12194440e-4f), high);
    __m512 series = _mm512_set1_ps(1.0f / 5040);
    for (const float term : {1.0f / 720, 1.0f / 120, 1.0f / 24, 1.0f / 6, 0.5f, 1.0f, 1.0f})
        series = _mm512_fmadd_ps(series, r, _mm512_set1_ps(term));
    return _mm512_scalef_ps(series, n);
}

}  // namespace item3d::avx512
