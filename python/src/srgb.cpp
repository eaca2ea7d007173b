// A texture is decoded in each step of an optimisation, so its powers take vector instructions: the
// compiler vectorises power(), which has no branches and calls nothing, for several instruction
// sets. Each value is rounded by itself, so results are the same at any place of a tensor. Values
// that power() does not take go through the program's kernels.
#include "python/src/srgb.h"

#include "item3d/render/kernels/srgb.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace item3d::python {
namespace {

#if defined(__x86_64__) && !defined(__clang__)
#define ITEM3D_FOR_VECTORS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define ITEM3D_FOR_VECTORS
#endif

constexpr std::int64_t block = 4096;
/// Values in [-largest, largest] have powers within the range of floats.
constexpr float largest = 1e6f;

/// Returns x^exponent for x in [2^-20, 2^20] and |exponent| < 3, with a relative error of up to
/// 1e-6 for results in [2^-8, 2^8] and 5e-6 for others.
[[gnu::always_inline]] inline float power(float x, float exponent) {
    // x = 2^e m with m in [sqrt(1/2), sqrt(2)): log2(x) = e + log2(m), the latter by the series of
    // atanh((m - 1) / (m + 1)).
    constexpr std::int32_t root_of_half = 0x3f3504f3, mantissa_bits = 23;
    const std::int32_t bits = std::bit_cast<std::int32_t>(x);
    const std::int32_t e = (bits - root_of_half) >> mantissa_bits;
    const float m = std::bit_cast<float>(bits - (e << mantissa_bits));
    const float s = (m - 1) / (m + 1), s2 = s * s;
    const float series = 1.0f + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 / 9)));
    const float power_of_two =
        exponent * (static_cast<float>(e) + 2.88539008f * s * series);  // 2 / ln 2

    // 2^t = 2^n 2^r with r in [-1/2, 1/2], the latter by the series of exp(r ln 2).
    constexpr float rounding = 12582912.0f;  // 1.5 * 2^23: adding it rounds to a whole number
    const float n = (power_of_two + rounding) - rounding;
    const float r = 0.693147181f * (power_of_two - n);
    const float exponential =
        1 + r * (1 + r * (1.0f / 2 +
                          r * (1.0f / 6 +
                               r * (1.0f / 24 + r * (1.0f / 120 + r * (1.0f / 720 + r / 5040))))));
    return std::bit_cast<float>(std::bit_cast<std::int32_t>(exponential) +
                                (static_cast<std::int32_t>(n) << mantissa_bits));
}

/// A curve or its gradient for `count` values in [-largest, largest].
using Vectorised = void (*)(const float* in, const float* gradient, float* out, std::int64_t count);
/// The same for one value, whatever it is.
using Exact = void (*)(const kernels::CurveParameters& p, std::int64_t i);

ITEM3D_FOR_VECTORS void decode(const float* __restrict in, const float*, float* __restrict out,
                               std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i) {
        const float bright = power((std::max(in[i], 0.04045f) + 0.055f) / 1.055f, 2.4f);
        out[i] = in[i] <= 0.04045f ? in[i] / 12.92f : bright;
    }
}

ITEM3D_FOR_VECTORS void decode_backward(const float* __restrict in,
                                        const float* __restrict gradient, float* __restrict out,
                                        std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i) {
        const float bright = power((std::max(in[i], 0.04045f) + 0.055f) / 1.055f, 1.4f);
        out[i] = gradient[i] * (in[i] <= 0.04045f ? 1 / 12.92f : (2.4f / 1.055f) * bright);
    }
}

ITEM3D_FOR_VECTORS void encode(const float* __restrict in, const float*, float* __restrict out,
                               std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i) {
        const float bright = 1.055f * power(std::max(in[i], 0.0031308f), 1 / 2.4f) - 0.055f;
        out[i] = in[i] <= 0.0031308f ? 12.92f * in[i] : bright;
    }
}

ITEM3D_FOR_VECTORS void encode_backward(const float* __restrict in,
                                        const float* __restrict gradient, float* __restrict out,
                                        std::int64_t count) {
    for (std::int64_t i = 0; i < count; ++i) {
        const float bright = (1.055f / 2.4f) * power(std::max(in[i], 0.0031308f), 1 / 2.4f - 1);
        out[i] = gradient[i] * (in[i] <= 0.0031308f ? 12.92f : bright);
    }
}

ITEM3D_FOR_VECTORS bool all_within(const float* values, std::int64_t count) {
    std::int32_t outside = 0;  // an integer: the compiler does not vectorise a bool
    for (std::int64_t i = 0; i < count; ++i)
        outside += std::abs(values[i]) <= largest ? 0 : 1;
    return outside == 0;
}

/// A curve: the CPU's function for blocks of values, that for single values, and the device's.
struct Curve {
    Vectorised vectorised;
    Exact exact;
    Operation::Entry<kernels::CurveParameters> entry;
};

/// Returns the values of a curve. With a gradient, returns the gradient with respect to the input.
Tensor apply(const char* operation, const Tensor& in_, const Tensor* gradient_,
             const Curve& curve) {
    const Operation call(operation, in_);
    const Sizes sizes = sizes_of(in_);
    const Tensor in = call.checked("values", in_, ScalarType::Float, sizes);
    const Tensor out = call.empty(sizes);
    kernels::CurveParameters p{floats(in), nullptr, mutable_floats(out)};
    Tensor gradient;
    if (gradient_) {
        gradient = call.checked("gradient", *gradient_, ScalarType::Float, sizes);
        p.gradient = floats(gradient);
    }
    const std::int64_t count = in.numel();
    if (call.on_device()) {
        call.launch(curve.entry, p, count);
        return out;
    }
    parallel_for(
        operation, (count + block - 1) / block,
        [&](std::int64_t number) {
            const std::int64_t first = number * block, length = std::min(block, count - first);
            if (all_within(p.in + first, length))
                curve.vectorised(p.in + first, gradient_ ? p.gradient + first : nullptr,
                                 p.out + first, length);
            else
                for (std::int64_t i = first; i < first + length; ++i)
                    curve.exact(p, i);
        },
        4);
    return out;
}

using Table = cuda::RenderTable;

}  // namespace

Tensor srgb_to_linear(const Tensor& encoded) {
    return apply("srgb_to_linear", encoded, nullptr,
                 {decode, kernels::srgb_to_linear, &Table::srgb_to_linear});
}

Tensor srgb_to_linear_backward(const Tensor& encoded, const Tensor& gradient) {
    return apply(
        "srgb_to_linear backward", encoded, &gradient,
        {decode_backward, kernels::srgb_to_linear_backward, &Table::srgb_to_linear_backward});
}

Tensor linear_to_srgb(const Tensor& linear) {
    return apply("linear_to_srgb", linear, nullptr,
                 {encode, kernels::linear_to_srgb, &Table::linear_to_srgb});
}

Tensor linear_to_srgb_backward(const Tensor& linear, const Tensor& gradient) {
    return apply(
        "linear_to_srgb backward", linear, &gradient,
        {encode_backward, kernels::linear_to_srgb_backward, &Table::linear_to_srgb_backward});
}

}  // namespace item3d::python
