// A texture is decoded in each step of an optimisation, so powers must be fast: power() has no
// branches and calls no functions, so that the compiler vectorises it. Each value is rounded
// independently, so a result does not depend on its place in the tensor. A block with a value
// outside power()'s range is computed by the kernels of the program item3d.
#include "python/src/srgb.h"

#include "item3d/render/kernels/srgb.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace item3d::python {
namespace {

constexpr std::int64_t block = 4096;
/// Powers of values in [-largest, largest] are within the range of floats.
constexpr float largest = 1e6f;

/// Returns x^exponent for x in [2^-20, 2^20] and |exponent| < 3, with a relative error of up to
/// 1e-6 for results in [2^-8, 2^8] and 5e-6 for others.
inline float power(float x, float exponent) {
    // x = 2^e m with m in [sqrt(1/2), sqrt(2)), so log2(x) = e + log2(m). The series of
    // atanh((m - 1) / (m + 1)) gives log2(m).
    constexpr std::int32_t root_of_half = 0x3f3504f3, mantissa_bits = 23;
    const std::int32_t bits = std::bit_cast<std::int32_t>(x);
    const std::int32_t e = (bits - root_of_half) >> mantissa_bits;
    const float m = std::bit_cast<float>(bits - (e << mantissa_bits));
    const float s = (m - 1) / (m + 1), s2 = s * s;
    const float series = 1.0f + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 / 9)));
    const float power_of_two =
        exponent * (static_cast<float>(e) + 2.88539008f * s * series);  // 2 / ln 2

    // 2^t = 2^n 2^r with r in [-1/2, 1/2]. The series of exp(r ln 2) gives 2^r.
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

struct Decode {
    static float value(float x) {
        const float bright = power((std::max(x, 0.04045f) + 0.055f) / 1.055f, 2.4f);
        return x <= 0.04045f ? x / 12.92f : bright;
    }
    static float slope(float x) {
        const float bright = power((std::max(x, 0.04045f) + 0.055f) / 1.055f, 1.4f);
        return x <= 0.04045f ? 1 / 12.92f : (2.4f / 1.055f) * bright;
    }
    static void exact_value(const kernels::CurveParameters& p, std::int64_t i) {
        kernels::srgb_to_linear(p, i);
    }
    static void exact_gradient(const kernels::CurveParameters& p, std::int64_t i) {
        kernels::srgb_to_linear_backward(p, i);
    }
};

struct Encode {
    static float value(float x) {
        const float bright = 1.055f * power(std::max(x, 0.0031308f), 1 / 2.4f) - 0.055f;
        return x <= 0.0031308f ? 12.92f * x : bright;
    }
    static float slope(float x) {
        const float bright = (1.055f / 2.4f) * power(std::max(x, 0.0031308f), 1 / 2.4f - 1);
        return x <= 0.0031308f ? 12.92f : bright;
    }
    static void exact_value(const kernels::CurveParameters& p, std::int64_t i) {
        kernels::linear_to_srgb(p, i);
    }
    static void exact_gradient(const kernels::CurveParameters& p, std::int64_t i) {
        kernels::linear_to_srgb_backward(p, i);
    }
};

bool all_within(const float* values, std::int64_t count) {
    std::int32_t outside = 0;  // an integer, because the compiler does not vectorise with a bool
    for (std::int64_t i = 0; i < count; ++i)
        outside += std::abs(values[i]) <= largest ? 0 : 1;
    return outside == 0;
}

template <typename Curve>
void value_block(const kernels::CurveParameters& p, std::int64_t first, std::int64_t count) {
    const float* __restrict in = p.in + first;
    float* __restrict out = p.out + first;
    if (all_within(in, count))
        for (std::int64_t i = 0; i < count; ++i)
            out[i] = Curve::value(in[i]);
    else
        for (std::int64_t i = 0; i < count; ++i)
            Curve::exact_value(p, first + i);
}

template <typename Curve>
void gradient_block(const kernels::CurveParameters& p, std::int64_t first, std::int64_t count) {
    const float* __restrict in = p.in + first;
    const float* __restrict gradient = p.gradient + first;
    float* __restrict out = p.out + first;
    if (all_within(in, count))
        for (std::int64_t i = 0; i < count; ++i)
            out[i] = gradient[i] * Curve::slope(in[i]);
    else
        for (std::int64_t i = 0; i < count; ++i)
            Curve::exact_gradient(p, first + i);
}

/// Returns the values of a curve or, if a gradient is given, the gradient with respect to the
/// input.
template <typename Curve>
Tensor apply(const char* operation, const Tensor& in_, const Tensor* gradient_) {
    const auto found = in_.sizes();
    const Sizes sizes(found.begin(), found.end());
    const Tensor in = checked(operation, "values", in_, ScalarType::Float, sizes);
    const Tensor out = new_tensor(sizes);
    kernels::CurveParameters p{floats(in), nullptr, mutable_floats(out)};
    Tensor gradient;
    if (gradient_) {
        gradient = checked(operation, "gradient", *gradient_, ScalarType::Float, sizes);
        p.gradient = floats(gradient);
    }
    const std::int64_t count = in.numel();
    parallel_for(
        operation, (count + block - 1) / block,
        [&](std::int64_t i) {
            const std::int64_t first = i * block, length = std::min(block, count - first);
            if (p.gradient)
                gradient_block<Curve>(p, first, length);
            else
                value_block<Curve>(p, first, length);
        },
        4);
    return out;
}

}  // namespace

Tensor srgb_to_linear(const Tensor& encoded) {
    return apply<Decode>("srgb_to_linear", encoded, nullptr);
}

Tensor srgb_to_linear_backward(const Tensor& encoded, const Tensor& gradient) {
    return apply<Decode>("srgb_to_linear backward", encoded, &gradient);
}

Tensor linear_to_srgb(const Tensor& linear) {
    return apply<Encode>("linear_to_srgb", linear, nullptr);
}

Tensor linear_to_srgb_backward(const Tensor& linear, const Tensor& gradient) {
    return apply<Encode>("linear_to_srgb backward", linear, &gradient);
}

}  // namespace item3d::python
