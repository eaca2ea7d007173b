// Scalar reference versions of the networks' kernels, in double, and helpers for their tests:
// random numbers of each type, aligned memory, instruction sets, and error bounds.
//
// A sum of n products in float has an error of at most n u sum |a_i b_i| in any order of summation,
// with u = 2^-24 (Higham 2002, "Accuracy and Stability of Numerical Algorithms", section 3.1).
// Therefore each scalar version returns the sum of magnitudes beside each value.
#pragma once

#include "item3d/kernels/cpu/dispatch.h"
#include "item3d/kernels/cpu/linear/matrix_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <type_traits>
#include <vector>

namespace item3d::testing {

inline double widen(float value) {
    return value;
}
inline double widen(BFloat16 value) {
    const std::uint32_t bits = static_cast<std::uint32_t>(value.bits) << 16;
    float number;
    std::memcpy(&number, &bits, sizeof number);
    return number;
}

/// Converts a finite number to double. Subnormal numbers become zero.
inline double widen(Float16 value) {
    const int exponent = value.bits >> 10 & 31, mantissa = value.bits & 1023;
    const double number = exponent == 0 ? 0.0 : std::ldexp(1024 + mantissa, exponent - 25);
    return (value.bits & 0x8000) != 0 ? -number : number;
}

/// Unit roundoff: half the distance between neighbouring numbers of a type, relative to the number.
template <typename Number>
constexpr double rounding = std::is_same_v<Number, BFloat16>  ? 1.0 / 256
                            : std::is_same_v<Number, Float16> ? 1.0 / 2048
                                                              : 1.0 / (1 << 24);

/// Sets `to` to a random number between -1 and 1.
inline void set_random(std::mt19937& random, float& to) {
    to = std::uniform_real_distribution<float>(-1, 1)(random);
}
inline void set_random(std::mt19937& random, BFloat16& to) {
    float number;
    set_random(random, number);
    std::uint32_t bits;
    std::memcpy(&bits, &number, sizeof bits);
    to.bits = static_cast<std::uint16_t>(bits >> 16);
}
inline void set_random(std::mt19937& random, Float16& to) {
    const auto sign = random() % 2, exponent = 9 + random() % 6, mantissa = random() % 1024;
    to.bits = static_cast<std::uint16_t>(sign << 15 | exponent << 10 | mantissa);
}

template <typename Number>
std::vector<Number> random_numbers(std::int64_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<Number> numbers(static_cast<std::size_t>(count));
    for (Number& number : numbers)
        set_random(random, number);
    return numbers;
}

/// Array whose address is a multiple of 64 bytes.
class AlignedMemory {
  public:
    explicit AlignedMemory(std::int64_t bytes) : lines_(static_cast<std::size_t>(bytes / 64 + 1)) {}
    template <typename Number>
    Number* as() {
        return reinterpret_cast<Number*>(lines_.data());
    }

  private:
    struct alignas(64) Line {
        unsigned char bytes[64] = {};
    };
    std::vector<Line> lines_;
};

/// Calls f.template operator()<level>() for each instruction set that has kernels of Number, that
/// the processor has and that ITEM3D_CPU allows. Returns the number of calls.
template <typename Number, typename Function>
int for_each_level([[maybe_unused]] const Function& f) {
    int levels = 0;
#if defined(ITEM3D_HAS_VECTOR_KERNELS)
    const InstructionSet highest = instruction_set_for<Number>();
    if constexpr (std::is_same_v<Number, float>) {
        if (highest == InstructionSet::avx2 ||
            (highest == InstructionSet::avx512 && __builtin_cpu_supports("avx2") &&
             __builtin_cpu_supports("fma") && __builtin_cpu_supports("f16c"))) {
            SCOPED_TRACE("AVX2");
            f.template operator()<InstructionSet::avx2>();
            ++levels;
        }
    }
    if (highest == InstructionSet::avx512) {
        SCOPED_TRACE("AVX-512");
        f.template operator()<InstructionSet::avx512>();
        ++levels;
    }
#endif
    return levels;
}

/// Results of a scalar version: the values, and for each value the sum of the magnitudes of its
/// terms.
struct Scalars {
    explicit Scalars(std::int64_t count)
        : value(static_cast<std::size_t>(count)), magnitude(static_cast<std::size_t>(count)) {}
    void add(std::size_t at, double term) {
        value[at] += term;
        magnitude[at] += std::abs(term);
    }
    std::vector<double> value, magnitude;
};

/// Expects sums of `terms` products in float, rounded to Number. The tolerance is twice the error
/// bound at the top of this file, which covers higher-order terms and values that are added at the
/// end.
template <typename Number>
void expect_sums(const std::vector<Number>& found, const Scalars& expected, std::int64_t terms) {
    ASSERT_EQ(found.size(), expected.value.size());
    const double sums = 2.0 * static_cast<double>(terms + 1) * rounding<float>;
    for (std::size_t i = 0; i < found.size(); ++i)
        ASSERT_NEAR(widen(found[i]), expected.value[i],
                    sums * expected.magnitude[i] +
                        2 * rounding<Number> * std::abs(expected.value[i]) + 1e-30)
            << "number " << i;
}

/// Returns y [images, height, width, out], the 3x3 cross-correlation with padding 1 of x [images,
/// height, width, in] with weights [out, 3, 3, in], plus bias [out].
template <typename Number, typename Weight>
Scalars scalar_convolution(const ConvolutionShape& shape, const std::vector<Number>& x,
                           const std::vector<Weight>& weights, const std::vector<float>& bias) {
    Scalars y(shape.pixels() * shape.out_channels);
    std::size_t at = 0;
    for (std::int64_t n = 0; n < shape.images; ++n)
        for (std::int64_t row = 0; row < shape.height; ++row)
            for (std::int64_t column = 0; column < shape.width; ++column)
                for (std::int64_t o = 0; o < shape.out_channels; ++o, ++at) {
                    y.add(at, bias[static_cast<std::size_t>(o)]);
                    for (int tap = 0; tap < 9; ++tap) {
                        const std::int64_t i = row + tap / 3 - 1, j = column + tap % 3 - 1;
                        if (i < 0 || j < 0 || i >= shape.height || j >= shape.width) continue;
                        const std::int64_t pixel = (n * shape.height + i) * shape.width + j;
                        for (std::int64_t c = 0; c < shape.in_channels; ++c)
                            y.add(
                                at,
                                widen(x[static_cast<std::size_t>(pixel * shape.in_channels + c)]) *
                                    widen(weights[static_cast<std::size_t>(
                                        (o * 9 + tap) * shape.in_channels + c)]));
                    }
                }
    return y;
}

/// Returns y [rows, columns] = x [rows, depth] weights [columns, depth]^T + bias [columns].
template <typename Number, typename Weight>
Scalars scalar_product(std::int64_t rows, std::int64_t columns, std::int64_t depth,
                       const std::vector<Number>& x, const std::vector<Weight>& weights,
                       const std::vector<float>& bias) {
    Scalars y(rows * columns);
    std::size_t at = 0;
    for (std::int64_t row = 0; row < rows; ++row)
        for (std::int64_t column = 0; column < columns; ++column, ++at) {
            y.add(at, bias[static_cast<std::size_t>(column)]);
            for (std::int64_t k = 0; k < depth; ++k)
                y.add(at, widen(x[static_cast<std::size_t>(row * depth + k)]) *
                              widen(weights[static_cast<std::size_t>(column * depth + k)]));
        }
    return y;
}

inline double scalar_sigmoid(double x) {
    return 1 / (1 + std::exp(-x));
}
/// Returns the cumulative distribution function of the standard normal distribution at x.
inline double scalar_normal(double x) {
    return 0.5 * std::erfc(-x / std::sqrt(2.0));
}
inline double scalar_gelu(double x) {
    return x * scalar_normal(x);
}
inline double scalar_gelu_slope(double x) {
    return scalar_normal(x) + x * std::exp(-0.5 * x * x) / std::sqrt(2 * M_PI);
}

}  // namespace item3d::testing
