// Tests of the 3x3 convolutions against sums of nine taps over all channels in double. The tests
// use each level of instructions that the processor has.
#include "item3d/kernels/cpu/conv/direct_kernel.h"
#include "item3d/kernels/cpu/conv/winograd_kernel.h"
#include "item3d/kernels/cpu/linear/amx_kernel.h"
#include "tests/support/scalar_kernels.h"

#include <algorithm>

namespace item3d {
namespace {

using testing::AlignedMemory;
using testing::Scalars;

/// Inputs of one convolution, and its result in double.
template <typename Number, typename Weight>
struct ConvolutionCase {
    explicit ConvolutionCase(const ConvolutionShape& of)
        : shape(of),
          x(testing::random_numbers<Number>(of.pixels() * of.in_channels, 1)),
          weights(testing::random_numbers<Weight>(of.out_channels * 9 * of.in_channels, 2)),
          bias(testing::random_numbers<float>(of.out_channels, 3)),
          expected(testing::scalar_convolution(of, x, weights, bias)) {}

    /// Calls pack(weights, out, in, column, packed) for each column of 64 output channels.
    template <typename Pack>
    void pack_columns(const Pack& pack, Weight* packed) const {
        for (std::int64_t column = 0; column < shape.out_channels; column += packed_columns)
            pack(weights.data() + column * 9 * shape.in_channels, shape.out_channels,
                 shape.in_channels, column, packed);
    }
    std::vector<Number> result() const { return std::vector<Number>(expected.value.size()); }

    ConvolutionShape shape;
    std::vector<Number> x;
    std::vector<Weight> weights;
    std::vector<float> bias;
    Scalars expected;
};

/// Calls f(first, last) for two ranges of unequal length. The first range ends inside of a block
/// that the kernel computes at once.
template <typename Function>
void in_two_parts(std::int64_t count, const Function& f) {
    const std::int64_t middle = std::min<std::int64_t>(count, 7);
    f(0, middle);
    if (middle < count) f(middle, count);
}

/// Calls f(first, last) for the columns of 64 channels, one by one.
template <typename Function>
void by_columns(std::int64_t channels, const Function& f) {
    for (std::int64_t first = 0; first < channels; first += packed_columns)
        f(first, std::min(first + packed_columns, channels));
}

/// Checks the relative error of all numbers together, and the largest error, which may be six times
/// as large relative to the largest number.
template <typename Number>
void expect_near_all(const std::vector<Number>& found, const Scalars& expected, double tolerance) {
    double error = 0, total = 0, worst = 0, largest = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const double difference = testing::widen(found[i]) - expected.value[i];
        error += difference * difference;
        total += expected.value[i] * expected.value[i];
        worst = std::max(worst, std::abs(difference));
        largest = std::max(largest, std::abs(expected.value[i]));
    }
    EXPECT_LT(std::sqrt(error / total), tolerance);
    EXPECT_LT(worst, 6 * tolerance * largest);
}

/// The tolerance is 1e-5 for float, six times the error of 256 channels in a simulation, and 1e-2
/// for bfloat16, two and a half times that error (docs/journal/benchmarks.md).
template <typename Number>
int compare_winograd(const ConvolutionShape& shape, double tolerance) {
    SCOPED_TRACE(::testing::Message() << shape.height << " x " << shape.width << ", "
                                      << shape.in_channels << " to " << shape.out_channels);
    const ConvolutionCase<Number, Number> of(shape);
    return testing::for_each_level<Number>([&]<InstructionSet level> {
        const WinogradKernel<Number> kernel = winograd_kernel<level, Number>();
        AlignedMemory packed(winograd_points<Number> * shape.out_channels * shape.in_channels *
                             static_cast<std::int64_t>(sizeof(Number)));
        of.pack_columns(kernel.pack, packed.as<Number>());
        std::vector<Number> y = of.result();
        in_two_parts(
            shape.tiles(winograd_tile<Number>), [&](std::int64_t first, std::int64_t last) {
                AlignedMemory scratch(kernel.scratch(last - first, shape.in_channels));
                kernel.convolve(shape, of.x.data(), packed.as<Number>(), of.bias.data(), y.data(),
                                {first, last, 0, shape.out_channels}, scratch.as<void>());
            });
        expect_near_all(y, of.expected, tolerance);
    });
}

TEST(ScalarWinograd, IsNineTapsInFloat) {
    // The shapes have complete and partial tiles of 4 x 4 pixels, less than one tile, and partial
    // columns of channels.
    int levels = compare_winograd<float>({2, 13, 18, 48, 80}, 1e-5);
    levels += compare_winograd<float>({1, 8, 12, 16, 16}, 1e-5);
    levels += compare_winograd<float>({5, 3, 1, 32, 144}, 1e-5);
    levels += compare_winograd<float>({1, 1, 7, 240, 64}, 1e-5);
    if (levels == 0) GTEST_SKIP() << "no instructions for it";
}

TEST(ScalarWinograd, IsNineTapsInBFloat16) {
    // Tiles are 2 x 2 pixels. AMX computes them in pairs of sixteen.
    int levels = compare_winograd<BFloat16>({2, 7, 9, 64, 128}, 1e-2);
    levels += compare_winograd<BFloat16>({1, 13, 18, 128, 64}, 1e-2);
    levels += compare_winograd<BFloat16>({3, 1, 1, 64, 64}, 1e-2);
    if (levels == 0) GTEST_SKIP() << "no instructions for it";
}

template <typename Number, typename Weight>
int compare_direct(const ConvolutionShape& shape) {
    SCOPED_TRACE(::testing::Message() << shape.height << " x " << shape.width << ", "
                                      << shape.in_channels << " to " << shape.out_channels);
    const ConvolutionCase<Number, Weight> of(shape);
    return testing::for_each_level<Number>([&]<InstructionSet level> {
        const DirectKernel<Weight> kernel = direct_kernel<level, Weight>();
        AlignedMemory packed(9 * shape.out_channels * shape.in_channels *
                             static_cast<std::int64_t>(sizeof(Weight)));
        of.pack_columns(kernel.pack, packed.as<Weight>());
        std::vector<Number> y = of.result();
        in_two_parts(shape.pixels(), [&](std::int64_t first, std::int64_t last) {
            AlignedMemory scratch(kernel.scratch(last - first, shape.in_channels));
            by_columns(shape.out_channels, [&](std::int64_t channel, std::int64_t after) {
                kernel.convolve(shape, of.x.data(), packed.as<Weight>(), of.bias.data(), y.data(),
                                {first, last, channel, after}, scratch.as<void>());
            });
        });
        testing::expect_sums(y, of.expected, 9 * shape.in_channels);
    });
}

TEST(ScalarDirectConvolution, IsNineTaps) {
    // Rows are computed in groups of six, complete and partial; columns have 64, 48 or 16 channels.
    int levels = compare_direct<float, float>({2, 7, 5, 48, 112});
    levels += compare_direct<float, float>({1, 1, 1, 16, 16});
    levels += compare_direct<float, Float16>({3, 4, 3, 32, 80});
    levels += compare_direct<BFloat16, BFloat16>({2, 5, 7, 64, 128});
    if (levels == 0) GTEST_SKIP() << "no instructions for it";
}

/// Returns the three input maps of convolve_taps_amx(). At each pixel they hold the left neighbour,
/// the pixel itself and the right neighbour. Sixteen pixels of zeros follow.
[[maybe_unused]] std::vector<BFloat16> shifted_by_pixels(const ConvolutionShape& shape,
                                                         const std::vector<BFloat16>& x) {
    const std::int64_t in = shape.in_channels, rows = shape.height + 2;
    std::vector<BFloat16> maps(
        static_cast<std::size_t>((3 * shape.images * rows * shape.width + 16) * in));
    for (int map = 0; map < 3; ++map)
        for (std::int64_t n = 0; n < shape.images; ++n)
            for (std::int64_t row = 0; row < shape.height; ++row)
                for (std::int64_t column = 0; column < shape.width; ++column) {
                    const std::int64_t seen = column + map - 1;
                    if (seen < 0 || seen >= shape.width) continue;
                    const std::int64_t from = (n * shape.height + row) * shape.width + seen;
                    const std::int64_t to =
                        ((map * shape.images + n) * rows + row + 1) * shape.width + column;
                    std::copy_n(x.begin() + from * in, in, maps.begin() + to * in);
                }
    return maps;
}

TEST(ScalarDirectConvolution, IsNineTapsOnAmx) {
    if (!amx_available()) GTEST_SKIP() << "no instructions for it";
#if defined(ITEM3D_HAS_VECTOR_KERNELS)
    // Tiles have sixteen pixels. The shapes have partial and complete tiles, and an odd number of
    // them.
    for (const ConvolutionShape& shape :
         {ConvolutionShape{2, 7, 5, 64, 128}, ConvolutionShape{3, 4, 4, 128, 64},
          ConvolutionShape{1, 1, 3, 64, 64}}) {
        const ConvolutionCase<BFloat16, BFloat16> of(shape);
        AlignedMemory packed(9 * shape.out_channels * shape.in_channels * 2);
        of.pack_columns(direct_kernel<InstructionSet::avx512, BFloat16>().pack,
                        packed.as<BFloat16>());
        const std::vector<BFloat16> shifted = shifted_by_pixels(shape, of.x);
        std::vector<BFloat16> y = of.result();
        const std::int64_t tiles = unit_tiles(shape), middle = (tiles + 1) / 2;
        for (const auto& [first, last] : {std::pair(std::int64_t{0}, middle), {middle, tiles}}) {
            if (first == last) continue;
            AlignedMemory scratch(unit_taps_scratch(last - first));
            convolve_taps_amx(shape, shifted.data(), packed.as<BFloat16>(), of.bias.data(),
                              y.data(), {first, last, 0, shape.out_channels}, scratch.as<void>());
        }
        testing::expect_sums(y, of.expected, 9 * shape.in_channels);
    }
#endif
}

}  // namespace
}  // namespace item3d
