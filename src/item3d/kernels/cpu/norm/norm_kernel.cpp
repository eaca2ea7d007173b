// The passes of group norm over a map, sixteen channels at a time.
//
//     pixels    c0 ......... c15 | c16 ......... c31 | ..
//       0            |                                       sums run down the pixels,
//       1            v                                       32 of them in float,
//      ..                                                    then added to doubles
//
// SiLU'(t) = s (1 + t (1 - s)) with s = 1 / (1 + e^-t).
#include "item3d/kernels/cpu/norm/norm_kernel.h"

#include "item3d/kernels/cpu/simd.h"

#include <algorithm>

namespace item3d {
namespace ITEM3D_INSTRUCTIONS {
namespace {

using std::int64_t;

/// Number of pixels whose sums are kept in float before they are added in double. With more pixels,
/// the sums lose more digits (up to five bits for 32 terms); with fewer, they are converted more
/// often.
constexpr int64_t float_pixels = 32;

ITEM3D_INLINE Lanes sigmoid(Lanes x) {
    // The argument is clamped to +-80, where e^80 is still within the range of float.
    const Lanes maximum = all(80);
    const Lanes negative = larger(smaller(-x, maximum), -maximum);
    const Lanes one = all(1);
    return one / (one + exponential(negative));
}

ITEM3D_INLINE Lanes silu_of(Lanes x) {
    return x * sigmoid(x);
}

ITEM3D_INLINE Lanes silu_slope(Lanes x) {
    const Lanes one = all(1), s = sigmoid(x);
    return s * (one + x * (one - s));
}

/// Returns the gradient with respect to the argument, scale x + offset, of f.
template <typename Number>
ITEM3D_INLINE Lanes inner_gradient(const Number* x, const Number* dy, Lanes scale, Lanes offset,
                                   bool silu) {
    const Lanes gradient = load(dy);
    if (!silu) return gradient;
    return gradient * silu_slope(multiply_add(scale, load(x), offset));
}

template <typename Number>
void add_channel_sums(const Number* x, int64_t pixels, int64_t channels, const float* shift,
                      double* sum, double* square) {
    for (int64_t first = 0; first < pixels; first += float_pixels) {
        const int64_t last = std::min(pixels, first + float_pixels);
        for (int64_t c = 0; c < channels; c += lanes) {
            const Lanes middle = load(shift + c);
            Lanes sums = zero(), squares = zero();
            for (int64_t i = first; i < last; ++i) {
                const Lanes value = load(x + i * channels + c) - middle;
                sums += value;
                squares = multiply_add(value, value, squares);
            }
            add_to(sum + c, sums);
            add_to(square + c, squares);
        }
    }
}

template <typename Number>
void apply_norm(const Number* x, int64_t pixels, int64_t channels, const float* scale,
                const float* offset, bool silu, Number* y) {
    for (int64_t i = 0; i < pixels * channels; i += channels) {
        for (int64_t c = 0; c < channels; c += lanes) {
            const Lanes value = multiply_add(load(scale + c), load(x + i + c), load(offset + c));
            store(y + i + c, silu ? silu_of(value) : value);
        }
    }
}

template <typename Number>
void add_gradient_sums(const Number* x, const Number* dy, int64_t pixels, int64_t channels,
                       const float* scale, const float* offset, const float* shift, bool silu,
                       double* sum, double* product) {
    for (int64_t first = 0; first < pixels; first += float_pixels) {
        const int64_t last = std::min(pixels, first + float_pixels);
        for (int64_t c = 0; c < channels; c += lanes) {
            const Lanes a = load(scale + c), b = load(offset + c), middle = load(shift + c);
            Lanes sums = zero(), products = zero();
            for (int64_t i = first * channels + c; i < last * channels; i += channels) {
                const Lanes gradient = inner_gradient(x + i, dy + i, a, b, silu);
                sums += gradient;
                products = multiply_add(gradient, load(x + i) - middle, products);
            }
            add_to(sum + c, sums);
            add_to(product + c, products);
        }
    }
}

template <typename Number>
void apply_norm_gradient(const Number* x, const Number* dy, int64_t pixels, int64_t channels,
                         const float* scale, const float* offset, const float* constant,
                         const float* slope, bool silu, Number* dx) {
    for (int64_t i = 0; i < pixels * channels; i += channels) {
        for (int64_t c = 0; c < channels; c += lanes) {
            const Lanes a = load(scale + c);
            const Lanes gradient = inner_gradient(x + i + c, dy + i + c, a, load(offset + c), silu);
            const Lanes common = multiply_add(load(slope + c), load(x + i + c), load(constant + c));
            store(dx + i + c, multiply_add(a, gradient, common));
        }
    }
}

template <typename Number>
constexpr NormKernel<Number> norm_functions{add_channel_sums<Number>, apply_norm<Number>,
                                            add_gradient_sums<Number>, apply_norm_gradient<Number>};

}  // namespace
}  // namespace ITEM3D_INSTRUCTIONS

template <>
NormKernel<float> norm_kernel<InstructionSet::ITEM3D_INSTRUCTIONS, float>() {
    return ITEM3D_INSTRUCTIONS::norm_functions<float>;
}

#ifdef __AVX512BF16__
template <>
NormKernel<BFloat16> norm_kernel<InstructionSet::avx512, BFloat16>() {
    return avx512::norm_functions<BFloat16>;
}
#endif

}  // namespace item3d
