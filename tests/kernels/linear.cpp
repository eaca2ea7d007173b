// Tests of products with packed weights, of the gate, and of the orders of weights, against plain
// loops in double. The tests use each level of instructions that the processor has.
#include "item3d/kernels/cpu/linear/gate_kernel.h"
#include "item3d/kernels/cpu/linear/linear_kernel.h"
#include "item3d/kernels/cpu/linear/weight_kernel.h"
#include "tests/support/scalar_kernels.h"

#include <algorithm>
#include <array>

namespace item3d {
namespace {

using testing::AlignedMemory;
using testing::Scalars;

struct ProductCase {
    std::int64_t rows, columns, depth;
};

double activated(double x, LinearActivation activation) {
    switch (activation) {
        case LinearActivation::gelu:
            return testing::scalar_gelu(x);
        case LinearActivation::quick_gelu:
            return x * testing::scalar_sigmoid(1.702 * x);
        default:
            return x;
    }
}

/// Bound of an activation's own error. The argument's error counts separately, times 1.2. GELU's
/// distribution function has an error below 7.5e-8 (normal_distribution.h), exponentials a few
/// roundings.
double activation_error(double x, LinearActivation activation) {
    return activation == LinearActivation::none ? 0.0 : 5e-7 * (1 + std::abs(x));
}

template <typename Weight>
int compare_product(const ProductCase& of) {
    using Number = Multiplied<Weight>;
    SCOPED_TRACE(::testing::Message()
                 << of.rows << " x " << of.depth << " by " << of.columns << " columns");
    const std::vector<Number> x = testing::random_numbers<Number>(of.rows * of.depth, 1);
    const std::vector<Weight> weights = testing::random_numbers<Weight>(of.columns * of.depth, 2);
    const std::vector<float> bias = testing::random_numbers<float>(of.columns, 3),
                             added = testing::random_numbers<float>(of.rows * of.columns, 4);
    const Scalars sums = testing::scalar_product(of.rows, of.columns, of.depth, x, weights, bias);
    return testing::for_each_level<Number>([&]<InstructionSet level> {
        const LinearKernel<Weight> kernel = linear_kernel<level, Weight>();
        AlignedMemory packed(packed_size(of.columns, of.depth) *
                             static_cast<std::int64_t>(sizeof(Weight)));
        const std::int64_t whole = of.columns / packed_columns * packed_columns;
        if (whole > 0) kernel.pack(weights.data(), of.depth, 0, whole, packed.as<Weight>());
        if (whole < of.columns)
            kernel.pack(weights.data(), of.depth, whole, of.columns, packed.as<Weight>());
        const std::int64_t middle = std::min<std::int64_t>(of.rows, 5);
        for (const LinearActivation activation :
             {LinearActivation::none, LinearActivation::gelu, LinearActivation::quick_gelu}) {
            std::vector<float> y(sums.value.size());
            std::vector<Number> rounded(y.size());
            for (const MatrixPart& part :
                 {MatrixPart{0, middle, 0, whole}, MatrixPart{0, middle, whole, of.columns},
                  MatrixPart{middle, of.rows, 0, of.columns}}) {
                kernel.multiply(x.data(), of.depth, packed.as<Weight>(),
                                {bias.data(), activation, added.data()}, of.columns, part,
                                y.data());
                kernel.multiply_rounded(x.data(), of.depth, packed.as<Weight>(),
                                        {bias.data(), activation, nullptr}, of.columns, part,
                                        rounded.data());
            }
            for (std::size_t i = 0; i < y.size(); ++i) {
                const double value = activated(sums.value[i], activation);
                // The slopes of both activations are below 1.2, so an argument's error grows by at
                // most this factor.
                const double error = 1.2 * 2 * static_cast<double>(of.depth + 1) *
                                         testing::rounding<float> * sums.magnitude[i] +
                                     activation_error(sums.value[i], activation);
                ASSERT_NEAR(y[i], value + added[i], error + 1e-7 * (1 + std::abs(value)))
                    << "number " << i;
                ASSERT_NEAR(testing::widen(rounded[i]), value,
                            error + 2 * testing::rounding<Number> * std::abs(value) + 1e-30)
                    << "rounded number " << i;
            }
        }
    });
}

TEST(ScalarLinear, IsALoopOverTheDepth) {
    // Rows are computed in groups of six, columns of 64 in registers of 16. The cases have complete
    // and partial groups and a single row.
    for (const ProductCase& of : {ProductCase{12, 128, 64}, ProductCase{7, 70, 48},
                                  ProductCase{1, 5, 16}, ProductCase{23, 177, 208}}) {
        const int levels = compare_product<float>(of) + compare_product<Float16>(of);
        compare_product<BFloat16>(of);
        if (levels == 0) GTEST_SKIP() << "no instructions for it";
    }
}

template <typename Number>
int compare_scalar_gate(std::int64_t rows, std::int64_t width) {
    std::vector<Number> x = testing::random_numbers<Number>(rows * 2 * width, 5);
    const std::vector<Number> dy = testing::random_numbers<Number>(rows * width, 6);
    return testing::for_each_level<Number>([&]<InstructionSet level> {
        const GateKernel<Number> kernel = gate_kernel<level, Number>();
        std::vector<Number> y(dy.size()), dx(x.size());
        kernel.apply(x.data(), rows, width, y.data());
        kernel.apply_gradient(x.data(), dy.data(), rows, width, dx.data());
        // GELU has an error of at most 7.5e-8 times its argument, and the result is rounded once.
        const auto expect = [](Number found, double expected) {
            EXPECT_NEAR(testing::widen(found), expected,
                        1e-6 + 2 * testing::rounding<Number> * std::abs(expected));
        };
        for (std::int64_t row = 0; row < rows; ++row)
            for (std::int64_t c = 0; c < width; ++c) {
                const auto value = static_cast<std::size_t>(2 * row * width + c),
                           gate = value + static_cast<std::size_t>(width),
                           at = static_cast<std::size_t>(row * width + c);
                const double a = testing::widen(x[value]), b = testing::widen(x[gate]),
                             d = testing::widen(dy[at]);
                expect(y[at], a * testing::scalar_gelu(b));
                expect(dx[value], d * testing::scalar_gelu(b));
                expect(dx[gate], d * a * testing::scalar_gelu_slope(b));
            }
    });
}

TEST(ScalarGate, IsValueTimesGeluOfTheGate) {
    const int levels = compare_scalar_gate<float>(5, 48) + compare_scalar_gate<float>(1, 16);
    compare_scalar_gate<BFloat16>(3, 80);
    if (levels == 0) GTEST_SKIP() << "no instructions for it";
}

/// Checks that weights [rows, in, 3, 3] get the order [rows, 3, 3, in]. If `exact`, the conversion
/// may lose nothing.
template <typename Stored, typename Number, typename Order>
void expect_ordered(const Order& order, bool exact) {
    constexpr std::int64_t rows = 3, in = 48, taps = 9;
    const std::vector<Stored> stored = testing::random_numbers<Stored>(rows * in * taps, 7);
    std::vector<Number> ordered(stored.size());
    order(stored.data(), rows, in, ordered.data());
    for (std::int64_t row = 0; row < rows; ++row)
        for (std::int64_t c = 0; c < in; ++c)
            for (std::int64_t tap = 0; tap < taps; ++tap) {
                const double wanted =
                    testing::widen(stored[static_cast<std::size_t>((row * in + c) * taps + tap)]);
                const double found =
                    testing::widen(ordered[static_cast<std::size_t>((row * taps + tap) * in + c)]);
                ASSERT_NEAR(found, wanted,
                            exact ? 0.0 : testing::rounding<Number> * std::abs(wanted))
                    << "row " << row << ", channel " << c << ", tap " << tap;
            }
}

/// Checks that fp16 numbers are converted one by one, also those after the last complete sixteen.
template <typename Number, typename Convert>
void expect_converted(const Convert& convert, bool exact) {
    for (const std::int64_t count : {1, 16, 37}) {
        const std::vector<Float16> halves = testing::random_numbers<Float16>(count, 8);
        std::vector<Number> converted(halves.size() + 1);
        convert(halves.data(), count, converted.data());
        for (std::size_t i = 0; i < halves.size(); ++i) {
            const double wanted = testing::widen(halves[i]);
            ASSERT_NEAR(testing::widen(converted[i]), wanted,
                        exact ? 0.0 : testing::rounding<Number> * std::abs(wanted))
                << i << " of " << count;
        }
        EXPECT_EQ(testing::widen(converted.back()), 0.0) << "written beyond the end";
    }
}

TEST(ScalarWeights, AreOrderedAndConvertedOneByOne) {
    const int levels = testing::for_each_level<float>([]<InstructionSet level> {
        const WeightKernel<float> floats = weight_kernel<level, float>();
        expect_ordered<float, float>(floats.order_floats, true);
        expect_ordered<BFloat16, float>(floats.order_bfloat16, true);
        expect_ordered<Float16, float>(floats.order_halves, true);
        expect_converted<float>(floats.convert_halves, true);
        const WeightKernel<Float16> halves = weight_kernel<level, Float16>();
        expect_ordered<Float16, Float16>(halves.order_halves, true);
        expect_converted<Float16>(halves.convert_halves, true);
    });
    testing::for_each_level<BFloat16>([]<InstructionSet level> {
        const WeightKernel<BFloat16> kernel = weight_kernel<level, BFloat16>();
        expect_ordered<float, BFloat16>(kernel.order_floats, false);
        expect_ordered<BFloat16, BFloat16>(kernel.order_bfloat16, true);
        expect_ordered<Float16, BFloat16>(kernel.order_halves, false);
        expect_converted<BFloat16>(kernel.convert_halves, false);
    });
    if (levels == 0) GTEST_SKIP() << "no instructions for it";
}

}  // namespace
}  // namespace item3d
