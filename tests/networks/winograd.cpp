#include "item3d/networks/layers/winograd.h"

#include "item3d/networks/diffusion/unet_blocks.h"
#include "item3d/networks/layers/conv3x3.h"
#include "item3d/networks/layers/direct_convolution.h"
#include "tests/support/networks.h"

#include <torch/csrc/autograd/autograd.h>

namespace item3d {
namespace {

double relative_error(const at::Tensor& actual, const at::Tensor& exact) {
    return ((actual.detach().to(at::kDouble) - exact).norm() / exact.norm()).item<double>();
}

/// Weights of a convolution, and its direct computation in any type.
struct Convolutions {
    Convolutions(int in, int out, at::ScalarType dtype) {
        at::manual_seed(in + out);
        weight = (at::randn({out, in, 3, 3}) / std::sqrt(9.0 * in)).to(dtype);
        bias = at::randn({out}).to(dtype);
    }
    at::Tensor direct(const at::Tensor& x) const {
        return at::conv2d(x, weight.to(x.scalar_type()), bias.to(x.scalar_type()), 1, 1);
    }
    at::Tensor weight, bias;
};

/// True if the machine has the instructions. Other machines convolve directly, which other tests
/// cover.
bool runs_here(at::ScalarType dtype) {
    return WinogradConvolution::gains(at::empty({2, 64, 32, 32}, dtype),
                                      at::empty({64, 64, 3, 3}, dtype));
}

/// Measures the errors of the output and of the input's gradient relative to a float64 reference.
/// Checks that each is at most `maximum` times the error of LibTorch's direct convolution.
template <typename Convolution>
void compare(at::ScalarType dtype, const std::vector<std::int64_t>& shape, int out,
             double maximum) {
    SCOPED_TRACE(::testing::Message() << "height " << shape[2] << ", width " << shape[3]);
    const Convolutions layer(static_cast<int>(shape[1]), out, dtype);
    Convolution fast(layer.weight, dtype);
    const at::Tensor x = at::randn(shape).to(dtype).requires_grad_(true);
    const at::Tensor exact_x = x.detach().to(at::kDouble).requires_grad_(true);
    const at::Tensor exact = layer.direct(exact_x), direct = layer.direct(x);
    const at::Tensor gradient = at::randn(exact.sizes()).to(dtype);
    EXPECT_LE(relative_error(fast.forward(x.detach(), layer.bias), exact),
              maximum * relative_error(direct, exact));
    const at::Tensor exact_back =
        torch::autograd::grad({exact}, {exact_x}, {gradient.to(at::kDouble)})[0];
    const at::Tensor direct_back = torch::autograd::grad({direct}, {x}, {gradient})[0];
    EXPECT_LE(relative_error(fast.backward(gradient), exact_back),
              maximum * relative_error(direct_back, exact_back));
}

TEST(Winograd, ErrsLittleMoreThanTheDirectConvolution) {
    for (const auto& [dtype, maximum] :
         {std::pair(at::kFloat, 10.0), std::pair(at::kBFloat16, 3.0)}) {
        if (!runs_here(dtype)) continue;
        // The shapes have whole tiles, partial tiles in each direction, and images of one tile or
        // less.
        compare<WinogradConvolution>(dtype, {2, 64, 16, 16}, 128, maximum);
        compare<WinogradConvolution>(dtype, {1, 128, 13, 18}, 64, maximum);
        compare<WinogradConvolution>(dtype, {3, 64, 18, 15}, 64, maximum);
        compare<WinogradConvolution>(dtype, {5, 64, 3, 1}, 64, maximum);
        compare<WinogradConvolution>(dtype, {1, 64, 1, 7}, 192, maximum);
        if (dtype == at::kBFloat16) continue;
        compare<WinogradConvolution>(dtype, {2, 48, 16, 16}, 144, maximum);  // partial columns
        compare<WinogradConvolution>(dtype, {1, 240, 9, 6}, 96, maximum);
    }
}

TEST(DirectConvolution, ErrsNoMoreThanTheLibrarys) {
    for (const at::ScalarType dtype : {at::kFloat, at::kBFloat16}) {
        if (!runs_here(dtype)) continue;
        // Sums have another order, so float32 errors differ by a few units in the last place.
        const double maximum = dtype == at::kFloat ? 8 : 1.1;
        compare<DirectConvolution>(dtype, {4, 128, 4, 4}, 64, maximum);
        compare<DirectConvolution>(dtype, {2, 64, 7, 5}, 192, maximum);
        compare<DirectConvolution>(dtype, {1, 64, 1, 1}, 64, maximum);
        compare<DirectConvolution>(dtype, {3, 64, 20, 13}, 128,
                                   maximum);  // several ranges of pixels
        if (dtype == at::kBFloat16) continue;
        compare<DirectConvolution>(dtype, {2, 48, 4, 4}, 144, maximum);  // partial columns
        compare<DirectConvolution>(dtype, {2, 112, 3, 8}, 16, maximum);
    }
}

TEST(DirectConvolution, KeepsHalvesAndLosesNothing) {
    if (!runs_here(at::kFloat)) GTEST_SKIP() << "no instructions for it";
    at::manual_seed(1);
    const at::Tensor halves = at::randn({128, 320, 3, 3}).to(at::kHalf);
    DirectConvolution kept(halves, at::kFloat), widened(halves.to(at::kFloat), at::kFloat);
    const at::Tensor x = at::randn({2, 320, 5, 6}), bias = at::randn({128}),
                     gradient = at::randn({2, 128, 5, 6});
    EXPECT_TRUE(at::equal(kept.forward(x, bias), widened.forward(x, bias)));
    EXPECT_TRUE(at::equal(kept.backward(gradient), widened.backward(gradient)));
}

TEST(Winograd, LeavesHeavyWeightsAndFewPixelsToOthersInFloat) {
    if (!runs_here(at::kFloat)) GTEST_SKIP() << "no instructions for it";
    const at::Tensor light = at::empty({320, 320, 3, 3}), heavy = at::empty({640, 640, 3, 3});
    EXPECT_TRUE(WinogradConvolution::gains(at::empty({4, 320, 16, 16}), light));
    EXPECT_FALSE(WinogradConvolution::gains(at::empty({4, 640, 16, 16}), heavy));
    EXPECT_TRUE(WinogradConvolution::gains(at::empty({4, 640, 32, 32}), heavy));
}

TEST(DirectConvolution, IsTakenForSmallMaps) {
    if (!runs_here(at::kBFloat16)) GTEST_SKIP() << "no instructions for bfloat16";
    const at::Tensor weight = at::randn({64, 64, 3, 3}).to(at::kBFloat16);
    const auto made_for = [&](const std::vector<std::int64_t>& shape) {
        return FrozenConvolution::make(at::empty(shape, at::kBFloat16), weight);
    };
    EXPECT_NE(std::dynamic_pointer_cast<DirectConvolution>(made_for({4, 64, 8, 8})), nullptr);
    EXPECT_NE(std::dynamic_pointer_cast<WinogradConvolution>(made_for({4, 64, 16, 16})), nullptr);
    EXPECT_EQ(FrozenConvolution::make(at::empty({4, 64, 8, 8}, at::kDouble), weight), nullptr);
}

TEST(Winograd, GivesTheSameOnOneThreadAndOnMany) {
    if (!runs_here(at::kFloat)) GTEST_SKIP() << "no instructions for it";
    const Convolutions layer(64, 128, at::kFloat);
    const WinogradConvolution fast(layer.weight, at::kFloat);
    const at::Tensor x = at::randn({1, 64, 40, 24});
    const at::Tensor one = fast.forward(x, layer.bias);
    at::set_num_threads(5);  // more than there are ranges of tiles
    const at::Tensor many = fast.forward(x, layer.bias);
    at::set_num_threads(testing::test_threads());
    EXPECT_TRUE(at::equal(one, many));
}

TEST(Conv3x3, FollowsItsWeightsAndTheirGradients) {
    Conv3x3 layer(64, 64);
    const auto expect_as_direct = [&](const at::Tensor& x) {
        const at::Tensor exact = at::conv2d(x.to(at::kDouble), layer->weight.to(at::kDouble),
                                            layer->bias.to(at::kDouble), 1, 1);
        EXPECT_LT(relative_error(layer(x), exact), 2e-6);
    };
    const at::Tensor x = at::randn({2, 64, 16, 16});
    layer(x).square().mean().backward();
    EXPECT_TRUE(layer->weight.grad().defined()) << "weights that ask for a gradient get one";

    for (at::Tensor& parameter : layer->parameters())
        parameter.set_requires_grad(false);
    expect_as_direct(x);
    {
        const at::NoGradGuard no_grad;
        layer->weight.mul_(2);
    }
    expect_as_direct(x);
    layer->weight.set_data(at::randn_like(layer->weight));
    expect_as_direct(x);
    expect_as_direct(x.slice(2, 0, 4));  // too few pixels to gain

    const at::Tensor asking = x.clone().requires_grad_(true);
    layer(asking).square().sum().backward();
    const at::Tensor same = x.clone().requires_grad_(true);
    at::conv2d(same, layer->weight, layer->bias, 1, 1).square().sum().backward();
    EXPECT_LT(relative_error(asking.grad(), same.grad().to(at::kDouble)), 2e-6);
}

TEST(Conv3x3, RunsWithReleasedWeights) {
    if (!runs_here(at::kBFloat16)) GTEST_SKIP() << "no instructions for bfloat16";
    const auto output_and_gradient = [](Conv3x3& layer) {
        at::manual_seed(3);
        const at::Tensor x = at::randn({2, 128, 16, 16}).to(at::kBFloat16).requires_grad_(true);
        const at::Tensor y = layer(x);
        return std::pair(y.detach(), torch::autograd::grad({y}, {x}, {at::randn_like(y)})[0]);
    };
    Conv3x3 layer(128, 64);
    for (at::Tensor& parameter : layer->parameters()) {
        parameter.set_requires_grad(false);
        parameter.set_data(parameter.to(at::kBFloat16));
    }
    const auto before = output_and_gradient(layer);
    layer->release_weights();
    const auto after = output_and_gradient(layer);
    EXPECT_EQ(layer->weight.numel(), 0);
    EXPECT_TRUE(at::equal(after.first, before.first));
    EXPECT_TRUE(at::equal(after.second, before.second));
    const at::Tensor x = at::randn({2, 128, 16, 16}).to(at::kBFloat16);
    // Images too small to choose it are convolved the same way now.
    EXPECT_TRUE(at::allclose(layer(x.slice(2, 0, 4)).slice(2, 0, 3), layer(x).slice(2, 0, 3)));
}

/// Returns a layer whose weights require no gradient.
Conv3x3 frozen_layer(int in, int out, at::ScalarType dtype) {
    at::manual_seed(in);
    Conv3x3 layer(in, out);
    for (at::Tensor& parameter : layer->parameters()) {
        parameter.set_requires_grad(false);
        parameter.set_data(parameter.to(dtype));
    }
    return layer;
}

void compare_from_file(at::ScalarType dtype) {
    for (const int in : {128, 24}) {  // packed, and left to LibTorch
        Conv3x3 layer = frozen_layer(in, 64, dtype), from_file = frozen_layer(in, 64, dtype);
        const at::Tensor stored = at::randn({64, in, 3, 3}).to(at::kHalf);
        layer->weight.set_data(stored.to(dtype).contiguous(at::MemoryFormat::ChannelsLast));
        int forgotten = 0;
        from_file->map_weights(stored, [&] { ++forgotten; });
        for (const int side : {16, 4}) {
            const at::Tensor x = at::randn({2, in, side, side}).to(dtype).requires_grad_(true);
            const at::Tensor y = layer(x), same = from_file(x), way = at::randn_like(y);
            EXPECT_TRUE(at::equal(y, same));
            EXPECT_TRUE(at::equal(torch::autograd::grad({y}, {x}, {way})[0],
                                  torch::autograd::grad({same}, {x}, {way})[0]));
        }
        EXPECT_GE(forgotten, 1) << in << " channels";
    }
}

TEST(Conv3x3, RunsFromTheWeightsOfAFile) {
    for (const at::ScalarType dtype : {at::kFloat, at::kBFloat16})
        if (runs_here(dtype)) compare_from_file(dtype);
}

TEST(FrozenConvolution, TurnsLargeWeightsRoundEachTime) {
    if (!runs_here(at::kBFloat16)) GTEST_SKIP() << "no instructions for bfloat16";
    // 5.3 MB and 3 MB of packed weights: those that are kept are rotated by the same code.
    compare<WinogradConvolution>(at::kBFloat16, {1, 384, 8, 8}, 448, 3.0);
    compare<DirectConvolution>(at::kBFloat16, {1, 640, 4, 4}, 512, 1.1);
    compare<DirectConvolution>(at::kFloat, {1, 320, 4, 4}, 512, 8);
}

TEST(Downsample, HasTheLibrarysGradientWithoutKeepingItsInput) {
    for (const int padding : {0, 1}) {
        at::manual_seed(1);
        Downsample down(8, padding);
        const at::Tensor x = at::randn({2, 8, 9, 12}).requires_grad_(true);
        const at::Tensor y = down(x), way = at::randn_like(y);
        const at::Tensor exact = torch::autograd::grad({y}, {x}, {way})[0];
        for (at::Tensor& parameter : down->parameters())
            parameter.set_requires_grad(false);
        const at::Tensor frozen = down(x);
        EXPECT_TRUE(at::allclose(frozen, y, 1e-5, 1e-6));
        EXPECT_TRUE(
            at::allclose(torch::autograd::grad({frozen}, {x}, {way})[0], exact, 1e-5, 1e-6));
    }
}

}  // namespace
}  // namespace item3d
