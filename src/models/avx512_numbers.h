// float and BrainFloat in registers of sixteen, for the files that are compiled for AVX-512 alone.
#pragma once

#include "item3d/models/brain_float.h"

#include <immintrin.h>

namespace item3d::avx512 {

/// Numbers of a register.
constexpr int lanes = 16;

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

inline void store(BrainFloat* to, __m512 value) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), narrow(value));
}

}  // namespace item3d::avx512
