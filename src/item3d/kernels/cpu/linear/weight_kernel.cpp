// The conversion of weights. For each sixteen channels of a row, 9 x 16 numbers are widened to
// floats in an array, and read back with a step of nine.
//
//     numbers [16, 9]:  c0 t0..t8 | c1 t0..t8 | .. | c15 t0..t8
//                          ^t        ^t                 ^t          gather(numbers + t, 9)
//
// If a count is not a multiple of sixteen, the rest is copied first, so that nothing beyond it is
// read or written.
#include "item3d/kernels/cpu/linear/weight_kernel.h"

#include "item3d/kernels/cpu/simd.h"

#include <cstring>

namespace item3d {
namespace ITEM3D_INSTRUCTIONS {
namespace {

using std::int64_t;

template <typename Stored, typename Number>
void order_taps(const Stored* weights, int64_t rows, int64_t in_channels, Number* ordered) {
    constexpr int taps = 9;
    float numbers[taps * lanes];
    for (int64_t row = 0; row < rows; ++row) {
        const Stored* from = weights + row * in_channels * taps;
        Number* to = ordered + row * taps * in_channels;
        for (int64_t c = 0; c < in_channels; c += lanes) {
            for (int i = 0; i < taps; ++i)
                store(numbers + i * lanes, load(from + c * taps + i * lanes));
            for (int tap = 0; tap < taps; ++tap)
                store(to + tap * in_channels + c, gather(numbers + tap, taps));
        }
    }
}

template <typename Number>
void convert_numbers(const Float16* from, int64_t count, Number* to) {
    int64_t i = 0;
    for (; i + lanes <= count; i += lanes)
        store(to + i, load(from + i));
    if (i == count) return;
    Float16 last[lanes] = {};
    Number converted[lanes];
    const auto rest = static_cast<std::size_t>(count - i);
    std::memcpy(last, from + i, rest * sizeof(Float16));
    store(converted, load(last));
    std::memcpy(to + i, converted, rest * sizeof(Number));
}

template <typename Number>
constexpr WeightKernel<Number> weight_functions{
    order_taps<float, Number>, order_taps<BFloat16, Number>, order_taps<Float16, Number>,
    convert_numbers<Number>};

}  // namespace
}  // namespace ITEM3D_INSTRUCTIONS

template <>
WeightKernel<float> weight_kernel<InstructionSet::ITEM3D_INSTRUCTIONS, float>() {
    return ITEM3D_INSTRUCTIONS::weight_functions<float>;
}

template <>
WeightKernel<Float16> weight_kernel<InstructionSet::ITEM3D_INSTRUCTIONS, Float16>() {
    return ITEM3D_INSTRUCTIONS::weight_functions<Float16>;
}

#ifdef __AVX512BF16__
template <>
WeightKernel<BFloat16> weight_kernel<InstructionSet::avx512, BFloat16>() {
    return avx512::weight_functions<BFloat16>;
}
#endif

}  // namespace item3d
