// Products with packed weights, for six rows and 64 columns at a time. The sums lie in a small
// array until bias, activation and added numbers are applied and the result is rounded.
//
//     for each block of 64 columns            its weights [depth, 64] stay in the cache
//         for each six rows                   beyond the end of the part the last row is repeated
//             sums [6, 64] = rows * block
//             y = f(sums + bias) + added
//
// quick_gelu(x) is x / (1 + e^(-1.702 x)). Its exponent is clamped to +-87, where e^x is still
// within the range of float.
#include "item3d/kernels/cpu/linear/linear_kernel.h"

#include "item3d/kernels/cpu/linear/matrix_tile.h"
#include "item3d/kernels/cpu/linear/normal_distribution.h"

#include <algorithm>
#include <cstring>

namespace item3d {
namespace ITEM3D_INSTRUCTIONS {
namespace {

using std::int64_t;

template <typename Weight>
void pack_columns(const Weight* weights, int64_t depth, int64_t first, int64_t last,
                  Weight* packed) {
    using Maths = Arithmetic<Weight>;
    for (int64_t column = first; column < last; column += packed_columns) {
        Weight* to = packed + column * depth;
        const int64_t there = std::min(packed_columns, last - column);
        const int64_t columns = whole_registers(there);
        if (there < columns)
            std::memset(to, 0, static_cast<std::size_t>(depth * columns) * sizeof(Weight));
        for (int64_t c = 0; c < depth; c += lanes)
            for (int64_t o = 0; o < there; ++o)
                Maths::scatter(to + c * columns + o * Maths::group, static_cast<int>(columns),
                               load(weights + (column + o) * depth + c));
    }
}

ITEM3D_INLINE Lanes quick_gelu(Lanes x) {
    const Lanes exponent = smaller(larger(x * all(-1.702f), all(-87)), all(87));
    return x / (all(1) + exponential(exponent));
}

ITEM3D_INLINE Lanes activate(Lanes x, LinearActivation activation) {
    switch (activation) {
        case LinearActivation::gelu:
            return gelu(x);
        case LinearActivation::quick_gelu:
            return quick_gelu(x);
        default:
            return x;
    }
}

template <typename Weight, typename Result>
void multiply_part(const Multiplied<Weight>* x, int64_t depth, const Weight* packed,
                   const ProductEnd& end, int64_t columns, const MatrixPart& part, Result* y) {
    alignas(64) float sums[rows * packed_columns];
    for (int64_t column = part.first_column; column < part.last_column; column += packed_columns) {
        const Weight* b = packed + column * depth;
        const int64_t there = std::min(packed_columns, part.last_column - column);
        for (int64_t row = part.first_row; row < part.last_row; row += rows) {
            const Multiplied<Weight>* a[rows];
            for (int i = 0; i < rows; ++i)  // the last row is repeated as padding
                a[i] = x + std::min(row + i, part.last_row - 1) * depth;
            multiply<Weight>(whole_registers(there), a, depth, b, sums, packed_columns, false);
            const int64_t count = std::min<int64_t>(rows, part.last_row - row);
            for (int64_t c = 0; c < there; c += lanes) {
                const Lanes bias = end.bias ? load_first(end.bias + column + c, there - c) : zero();
                for (int64_t i = 0; i < count; ++i) {
                    const int64_t place = (row + i) * columns + column + c;
                    Lanes value =
                        activate(load(sums + i * packed_columns + c) + bias, end.activation);
                    if (end.added) value += load_first(end.added + place, there - c);
                    store_first(y + place, there - c, value);
                }
            }
        }
    }
}

template <typename Weight>
constexpr LinearKernel<Weight> linear_functions{pack_columns<Weight>, multiply_part<Weight, float>,
                                                multiply_part<Weight, Multiplied<Weight>>};

}  // namespace
}  // namespace ITEM3D_INSTRUCTIONS

template <>
LinearKernel<float> linear_kernel<InstructionSet::ITEM3D_INSTRUCTIONS, float>() {
    return ITEM3D_INSTRUCTIONS::linear_functions<float>;
}

template <>
LinearKernel<Float16> linear_kernel<InstructionSet::ITEM3D_INSTRUCTIONS, Float16>() {
    return ITEM3D_INSTRUCTIONS::linear_functions<Float16>;
}

#ifdef __AVX512BF16__
template <>
LinearKernel<BFloat16> linear_kernel<InstructionSet::avx512, BFloat16>() {
    return avx512::linear_functions<BFloat16>;
}
#endif

}  // namespace item3d
