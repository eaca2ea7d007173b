#include "item3d/models/weight_kernel.h"

#if defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512VL__) && \
    defined(__AVX512BF16__)
#define ITEM3D_WEIGHTS 1
#include "item3d/models/avx512_numbers.h"
#endif

#include <cstring>

namespace item3d {

using std::int64_t;

#ifdef ITEM3D_WEIGHTS

template <typename Stored, typename Number>
void order_taps(const Stored* weights, int64_t rows, int64_t in_channels, Number* ordered) {
    using avx512::lanes;
    constexpr int taps = 9;
    const __m512i places =
        _mm512_mullo_epi32(_mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15),
                           _mm512_set1_epi32(taps));
    alignas(64) float numbers[taps * lanes];
    for (int64_t row = 0; row < rows; ++row) {
        const Stored* from = weights + row * in_channels * taps;
        Number* to = ordered + row * taps * in_channels;
        for (int64_t c = 0; c < in_channels; c += lanes) {
            for (int i = 0; i < taps; ++i)
                _mm512_store_ps(numbers + i * lanes, avx512::load(from + c * taps + i * lanes));
            for (int tap = 0; tap < taps; ++tap)
                avx512::store(to + tap * in_channels + c,
                              _mm512_i32gather_ps(places, numbers + tap, sizeof(float)));
        }
    }
}

void convert_numbers(const HalfFloat* from, int64_t count, BrainFloat* to) {
    int64_t i = 0;
    for (; i + avx512::lanes <= count; i += avx512::lanes)
        avx512::store(to + i, avx512::load(from + i));
    if (i == count) return;
    HalfFloat last[avx512::lanes] = {};
    BrainFloat converted[avx512::lanes];
    const auto rest = static_cast<std::size_t>(count - i);
    std::memcpy(last, from + i, rest * sizeof(HalfFloat));
    avx512::store(converted, avx512::load(last));
    std::memcpy(to + i, converted, rest * sizeof(BrainFloat));
}

#else

template <typename Stored, typename Number>
void order_taps(const Stored*, int64_t, int64_t, Number*) {}

void convert_numbers(const HalfFloat*, int64_t, BrainFloat*) {}

#endif

#define ITEM3D_INSTANTIATE(Number)                                          \
    template void order_taps(const HalfFloat*, int64_t, int64_t, Number*);  \
    template void order_taps(const BrainFloat*, int64_t, int64_t, Number*); \
    template void order_taps(const float*, int64_t, int64_t, Number*);
ITEM3D_INSTANTIATE(float)
ITEM3D_INSTANTIATE(BrainFloat)
ITEM3D_INSTANTIATE(HalfFloat)
#undef ITEM3D_INSTANTIATE

}  // namespace item3d
