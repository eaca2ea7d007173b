#include "item3d/models/linear_kernel.h"

#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512VL__) && \
    defined(__AVX512BF16__)
#define ITEM3D_LINEAR 1
#include "item3d/models/matrix_tile.h"
#endif

#include <algorithm>
#include <cstring>

namespace item3d {

using std::int64_t;

#ifdef ITEM3D_LINEAR

template <typename Weight>
void pack_columns(const Weight* weights, int64_t depth, int64_t first, int64_t last,
                  Weight* packed) {
    using Maths = avx512::Arithmetic<Weight>;
    for (int64_t column = first; column < last; column += packed_columns) {
        Weight* to = packed + column * depth;
        const int64_t there = std::min(packed_columns, last - column);
        if (there < packed_columns)
            std::memset(to, 0, static_cast<std::size_t>(depth * packed_columns) * sizeof(Weight));
        for (int64_t c = 0; c < depth; c += avx512::lanes)
            for (int64_t o = 0; o < there; ++o)
                Maths::scatter(to + c * packed_columns + o * Maths::group,
                               avx512::load(weights + (column + o) * depth + c));
    }
}

namespace {

/// x Phi(x) by Abramowitz and Stegun 7.1.26, within 1.5e-7 |x|.
__m512 gelu(__m512 x) {
    const __m512 z = _mm512_abs_ps(x) * _mm512_set1_ps(0.70710678f);
    const __m512 t =
        _mm512_set1_ps(1) / _mm512_fmadd_ps(z, _mm512_set1_ps(0.3275911f), _mm512_set1_ps(1));
    __m512 series = _mm512_set1_ps(1.061405429f);
    for (const float term : {-1.453152027f, 1.421413741f, -0.284496736f, 0.254829592f})
        series = _mm512_fmadd_ps(series, t, _mm512_set1_ps(term));
    const __m512 exponent = _mm512_max_ps(_mm512_setzero_ps() - z * z, _mm512_set1_ps(-87));
    const __m512 tail =  // x (1 - Phi(|x|))
        _mm512_set1_ps(0.5f) * x * t * series * avx512::exponential(exponent);
    const __mmask16 negative = _mm512_cmp_ps_mask(x, _mm512_setzero_ps(), _CMP_LT_OQ);
    return _mm512_mask_mov_ps(x - tail, negative, tail);
}

__m512 quick_gelu(__m512 x) {
    const __m512 exponent = _mm512_min_ps(
        _mm512_max_ps(x * _mm512_set1_ps(-1.702f), _mm512_set1_ps(-87)), _mm512_set1_ps(87));
    return x / (_mm512_set1_ps(1) + avx512::exponential(exponent));
}

__m512 activate(__m512 x, LinearActivation activation) {
    switch (activation) {
        case LinearActivation::gelu:
            return gelu(x);
        case LinearActivation::quick_gelu:
            return quick_gelu(x);
        default:
            return x;
    }
}

}  // namespace

template <typename Weight, typename Result>
void multiply_part(const Multiplied<Weight>* x, int64_t depth, const Weight* packed,
                   const ProductEnd& end, int64_t columns, const MatrixPart& part, Result* y) {
    alignas(64) float sums[avx512::rows * packed_columns];
    for (int64_t column = part.first_column; column < part.last_column; column += packed_columns) {
        const Weight* b = packed + column * depth;
        const int64_t there = std::min(packed_columns, part.last_column - column);
        for (int64_t row = part.first_row; row < part.last_row; row += avx512::rows) {
            const Multiplied<Weight>* a[avx512::rows];
            for (int i = 0; i < avx512::rows; ++i)  // the last row again for those that are missing
                a[i] = x + std::min(row + i, part.last_row - 1) * depth;
            avx512::multiply<Weight, 4>(a, depth, b, sums, packed_columns, false);
            const int64_t rows = std::min<int64_t>(avx512::rows, part.last_row - row);
            for (int64_t c = 0; c < there; c += avx512::lanes) {
                const __mmask16 mask = avx512::first_lanes(there - c);
                const __m512 bias = end.bias ? _mm512_maskz_loadu_ps(mask, end.bias + column + c)
                                             : _mm512_setzero_ps();
                for (int64_t i = 0; i < rows; ++i) {
                    const int64_t place = (row + i) * columns + column + c;
                    __m512 value = activate(avx512::load(sums + i * packed_columns + c) + bias,
                                            end.activation);
                    if (end.added) value += _mm512_maskz_loadu_ps(mask, end.added + place);
                    avx512::store_some(y + place, mask, value);
                }
            }
        }
    }
}

#else

template <typename Weight>
void pack_columns(const Weight*, int64_t, int64_t, int64_t, Weight*) {}

template <typename Weight, typename Result>
void multiply_part(const Multiplied<Weight>*, int64_t, const Weight*, const ProductEnd&, int64_t,
                   const MatrixPart&, Result*) {}

#endif

template void pack_columns(const float*, int64_t, int64_t, int64_t, float*);
template void pack_columns(const BrainFloat*, int64_t, int64_t, int64_t, BrainFloat*);
template void pack_columns(const HalfFloat*, int64_t, int64_t, int64_t, HalfFloat*);
#define ITEM3D_INSTANTIATE(Weight, Result)                                                 \
    template void multiply_part<Weight>(const Multiplied<Weight>*, int64_t, const Weight*, \
                                        const ProductEnd&, int64_t, const MatrixPart&, Result*);
ITEM3D_INSTANTIATE(float, float)
ITEM3D_INSTANTIATE(BrainFloat, float)
ITEM3D_INSTANTIATE(BrainFloat, BrainFloat)
ITEM3D_INSTANTIATE(HalfFloat, float)
#undef ITEM3D_INSTANTIATE

}  // namespace item3d
