// The gate and its gradient, for sixteen numbers at a time. One exponential serves the distribution
// function and the density (normal_distribution.h).
//
//     row of x:   a_0 .. a_15 a_16 ..  | b_0 .. b_15 b_16 ..
//                 ^ c                    ^ c + width
//
// Numbers are read in their type, computed with as floats, and rounded once when they are stored.
#include "item3d/kernels/cpu/linear/gate_kernel.h"

#include "item3d/kernels/cpu/linear/normal_distribution.h"

namespace item3d {
namespace ITEM3D_INSTRUCTIONS {
namespace {

using std::int64_t;

template <typename Number>
void apply_gate(const Number* x, int64_t rows, int64_t width, Number* y) {
    for (int64_t row = 0; row < rows; ++row) {
        const Number *values = x + 2 * row * width, *gates = values + width;
        for (int64_t c = 0; c < width; c += lanes)
            store(y + row * width + c, load(values + c) * gelu(load(gates + c)));
    }
}

template <typename Number>
void apply_gate_gradient(const Number* x, const Number* dy, int64_t rows, int64_t width,
                         Number* dx) {
    for (int64_t row = 0; row < rows; ++row) {
        const int64_t begin = 2 * row * width;
        for (int64_t c = 0; c < width; c += lanes) {
            const int64_t value = begin + c, gate = value + width;
            const Lanes b = load(x + gate), gradient = load(dy + row * width + c);
            const NormalDistribution normal = normal_distribution(b);
            const Lanes slope = multiply_add(b, normal.density, normal.below);
            store(dx + value, gradient * b * normal.below);
            store(dx + gate, gradient * load(x + value) * slope);
        }
    }
}

template <typename Number>
constexpr GateKernel<Number> gate_functions{apply_gate<Number>, apply_gate_gradient<Number>};

}  // namespace
}  // namespace ITEM3D_INSTRUCTIONS

template <>
GateKernel<float> gate_kernel<InstructionSet::ITEM3D_INSTRUCTIONS, float>() {
    return ITEM3D_INSTRUCTIONS::gate_functions<float>;
}

#ifdef __AVX512BF16__
template <>
GateKernel<BFloat16> gate_kernel<InstructionSet::avx512, BFloat16>() {
    return avx512::gate_functions<BFloat16>;
}
#endif

}  // namespace item3d
