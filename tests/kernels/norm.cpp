// Tests of the sums and maps of group norm against plain loops in double. The tests use each level
// of instructions that the processor has.
#include "item3d/kernels/cpu/norm/norm_kernel.h"
#include "tests/support/scalar_kernels.h"

namespace item3d {
namespace {

using testing::Scalars;

/// Value and slope of the activation f at t = scale x + offset.
struct NormActivation {
    double value, slope;
};
NormActivation norm_activation(double t, bool silu) {
    if (!silu) return {t, 1};
    const double s = testing::scalar_sigmoid(t);
    return {t * s, s * (1 + t * (1 - s))};
}

template <typename Number>
int compare_scalar_norm(std::int64_t pixels, std::int64_t channels, bool silu) {
    SCOPED_TRACE(::testing::Message() << pixels << " pixels, " << channels << " channels");
    const auto x = testing::random_numbers<Number>(pixels * channels, 1),
               dy = testing::random_numbers<Number>(pixels * channels, 2);
    const auto values = [&](unsigned seed) {
        return testing::random_numbers<float>(channels, seed);
    };
    const std::vector<float> shift = values(3), scale = values(4), offset = values(5),
                             constant = values(6), slope = values(7);
    // Sums over each channel: of x - shift, of its square, of the inner gradient g, and of g (x -
    // shift).
    Scalars sum(channels), square(channels), gradient(channels), product(channels);
    Scalars y(pixels * channels), dx(pixels * channels);
    std::size_t at = 0;
    for (std::int64_t i = 0; i < pixels; ++i)
        for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c, ++at) {
            const double value = testing::widen(x[at]), apart = value - shift[c];
            const NormActivation f = norm_activation(scale[c] * value + offset[c], silu);
            const double g = testing::widen(dy[at]) * f.slope;
            sum.add(c, apart);
            square.add(c, apart * apart);
            gradient.add(c, g);
            product.add(c, g * apart);
            y.add(at, f.value);
            for (const double term : {scale[c] * g, double(constant[c]), slope[c] * value})
                dx.add(at, term);
        }
    return testing::for_each_level<Number>([&]<InstructionSet level> {
        const NormKernel<Number> kernel = norm_kernel<level, Number>();
        const auto count = static_cast<std::size_t>(channels);
        // The kernel adds to the sums that are given.
        std::vector<double> sums(count, 1.0), squares(count, 2.0);
        kernel.add_channel_sums(x.data(), pixels, channels, shift.data(), sums.data(),
                                squares.data());
        std::vector<double> gradients(count, 3.0), products(count, 4.0);
        kernel.add_gradient_sums(x.data(), dy.data(), pixels, channels, scale.data(), offset.data(),
                                 shift.data(), silu, gradients.data(), products.data());
        // 32 terms are summed in float, each of which has a few roundings. The slope of SiLU has a
        // few more.
        const auto near = [](double found, double expected, double magnitude) {
            EXPECT_NEAR(found, expected, 100 * testing::rounding<float> * magnitude + 1e-12);
        };
        for (std::size_t c = 0; c < count; ++c) {
            near(sums[c] - 1, sum.value[c], sum.magnitude[c] + 32);
            near(squares[c] - 2, square.value[c], square.magnitude[c] + 32);
            near(gradients[c] - 3, gradient.value[c], gradient.magnitude[c] + 32);
            near(products[c] - 4, product.value[c], product.magnitude[c] + 32);
        }
        std::vector<Number> found_y(x.size()), found_dx(x.size());
        kernel.apply(x.data(), pixels, channels, scale.data(), offset.data(), silu, found_y.data());
        kernel.apply_gradient(x.data(), dy.data(), pixels, channels, scale.data(), offset.data(),
                              constant.data(), slope.data(), silu, found_dx.data());
        for (std::size_t i = 0; i < x.size(); ++i) {
            // Numbers are below 2, so a dozen roundings are below 2e-6.
            ASSERT_NEAR(testing::widen(found_y[i]), y.value[i],
                        2e-6 + 2 * testing::rounding<Number> * std::abs(y.value[i]));
            ASSERT_NEAR(testing::widen(found_dx[i]), dx.value[i],
                        2e-6 + 2 * testing::rounding<Number> * std::abs(dx.value[i]));
        }
    });
}

TEST(ScalarNorm, IsALoopOverThePixels) {
    for (const bool silu : {false, true}) {
        // Pixels are processed in groups of 32, channels in groups of 16, complete and partial.
        const int levels = compare_scalar_norm<float>(70, 48, silu) +
                           compare_scalar_norm<float>(1, 16, silu) +
                           compare_scalar_norm<float>(32, 80, silu);
        compare_scalar_norm<BFloat16>(33, 64, silu);
        if (levels == 0) GTEST_SKIP() << "no instructions for it";
    }
}

}  // namespace
}  // namespace item3d
