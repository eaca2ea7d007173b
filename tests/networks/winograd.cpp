#include "item3d/networks/layers/winograd.h"

#include "item3d/networks/diffusion/unet_blocks.h"
#include "item3d/networks/layers/conv3x3.h"
#include "item3d/networks/layers/direct_convolution.h"
#include "support/networks.h"

#include <torch/csrc/autograd/autograd.h>

namespace item3d {
namespace {

double relative_error(const torch::Tensor& actual, const torch::Tensor& exact) {
    return ((actual.detach().to(torch::kFloat64) - exact).norm() / exact.norm()).item<double>();
}

/// A convolution of the same weights beside one of float64.
struct Convolutions {
    Convolutions(int in, int out, torch::Dtype dtype) {
        torch::manual_seed(in + out);
        weight = (torch::randn({out, in, 3, 3}) / std::sqrt(9.0 * in)).to(dtype);
        bias = torch::randn({out}).to(dtype);
    }
    torch::Tensor direct(const torch::Tensor& x) const {
        return torch::conv2d(x, weight.to(x.scalar_type()), bias.to(x.scalar_type()), 1, 1);
    }
    torch::Tensor weight, bias;
};

/// A machine without the instructions convolves directly, which other tests look at.
bool runs_here(torch::Dtype dtype) {
    return WinogradConvolution::gains(torch::empty({2, 64, 32, 32}, dtype),
                                      torch::empty({64, 64, 3, 3}, dtype));
}

/// Errors against float64 of the output and of the input's gradient, each as a multiple of the
/// library's direct convolution's own.
template <typename Convolution>
void compare(torch::Dtype dtype, const std::vector<std::int64_t>& shape, int out, double most) {
    SCOPED_TRACE(::testing::Message() << "height " << shape[2] << ", width " << shape[3]);
    const Convolutions layer(static_cast<int>(shape[1]), out, dtype);
    Convolution fast(layer.weight, dtype);
    const torch::Tensor x = torch::randn(shape).to(dtype).requires_grad_(true);
    const torch::Tensor exact_x = x.detach().to(torch::kFloat64).requires_grad_(true);
    const torch::Tensor exact = layer.direct(exact_x), direct = layer.direct(x);
    const torch::Tensor gradient = torch::randn(exact.sizes()).to(dtype);
    EXPECT_LE(relative_error(fast.forward(x.detach(), layer.bias), exact),
              most * relative_error(direct, exact));
    const torch::Tensor exact_back =
        torch::autograd::grad({exact}, {exact_x}, {gradient.to(torch::kFloat64)})[0];
    const torch::Tensor direct_back = torch::autograd::grad({direct}, {x}, {gradient})[0];
    EXPECT_LE(relative_error(fast.backward(gradient), exact_back),
              most * relative_error(direct_back, exact_back));
}

TEST(Winograd, ErrsLittleMoreThanTheDirectConvolution) {
    for (const auto& [dtype, most] :
         {std::pair(torch::kFloat32, 10.0), std::pair(torch::kBFloat16, 3.0)}) {
        if (!runs_here(dtype)) continue;
        // Whole tiles, cut tiles in each direction, pictures of a tile or less.
        compare<WinogradConvolution>(dtype, {2, 64, 16, 16}, 128, most);
        compare<WinogradConvolution>(dtype, {1, 128, 13, 18}, 64, most);
        compare<WinogradConvolution>(dtype, {3, 64, 18, 15}, 64, most);
        compare<WinogradConvolution>(dtype, {5, 64, 3, 1}, 64, most);
        compare<WinogradConvolution>(dtype, {1, 64, 1, 7}, 192, most);
        if (dtype == torch::kBFloat16) continue;
        compare<WinogradConvolution>(dtype, {2, 48, 16, 16}, 144, most);  // cut columns
        compare<WinogradConvolution>(dtype, {1, 240, 9, 6}, 96, most);
    }
}

TEST(DirectConvolution, ErrsNoMoreThanTheLibrarys) {
    for (const torch::Dtype dtype : {torch::kFloat32, torch::kBFloat16}) {
        if (!runs_here(dtype)) continue;
        // Sums in another order: float32's errors differ by a few units in the last place.
        const double most = dtype == torch::kFloat32 ? 8 : 1.1;
        compare<DirectConvolution>(dtype, {4, 128, 4, 4}, 64, most);
        compare<DirectConvolution>(dtype, {2, 64, 7, 5}, 192, most);
        compare<DirectConvolution>(dtype, {1, 64, 1, 1}, 64, most);
        compare<DirectConvolution>(dtype, {3, 64, 20, 13}, 128, most);  // several ranges of pixels
        if (dtype == torch::kBFloat16) continue;
        compare<DirectConvolution>(dtype, {2, 48, 4, 4}, 144, most);  // cut columns
        compare<DirectConvolution>(dtype, {2, 112, 3, 8}, 16, most);
    }
}

TEST(DirectConvolution, KeepsHalvesAndLosesNothing) {
    if (!runs_here(torch::kFloat32)) GTEST_SKIP() << "no instructions for it";
    torch::manual_seed(1);
    const torch::Tensor halves = torch::randn({128, 320, 3, 3}).to(torch::kFloat16);
    DirectConvolution kept(halves, torch::kFloat32),
        widened(halves.to(torch::kFloat32), torch::kFloat32);
    const torch::Tensor x = torch::randn({2, 320, 5, 6}), bias = torch::randn({128}),
                        gradient = torch::randn({2, 128, 5, 6});
    EXPECT_TRUE(torch::equal(kept.forward(x, bias), widened.forward(x, bias)));
    EXPECT_TRUE(torch::equal(kept.backward(gradient), widened.backward(gradient)));
}

TEST(Winograd, LeavesHeavyWeightsAndFewPixelsToOthersInFloat) {
    if (!runs_here(torch::kFloat32)) GTEST_SKIP() << "no instructions for it";
    const torch::Tensor light = torch::empty({320, 320, 3, 3}),
                        heavy = torch::empty({640, 640, 3, 3});
    EXPECT_TRUE(WinogradConvolution::gains(torch::empty({4, 320, 16, 16}), light));
    EXPECT_FALSE(WinogradConvolution::gains(torch::empty({4, 640, 16, 16}), heavy));
    EXPECT_TRUE(WinogradConvolution::gains(torch::empty({4, 640, 32, 32}), heavy));
}

TEST(DirectConvolution, IsTakenForSmallMaps) {
    if (!runs_here(torch::kBFloat16)) GTEST_SKIP() << "no instructions for bfloat16";
    const torch::Tensor weight = torch::randn({64, 64, 3, 3}).to(torch::kBFloat16);
    const auto made_for = [&](const std::vector<std::int64_t>& shape) {
        return FrozenConvolution::make(torch::empty(shape, torch::kBFloat16), weight);
    };
    EXPECT_NE(std::dynamic_pointer_cast<DirectConvolution>(made_for({4, 64, 8, 8})), nullptr);
    EXPECT_NE(std::dynamic_pointer_cast<WinogradConvolution>(made_for({4, 64, 16, 16})), nullptr);
    EXPECT_EQ(FrozenConvolution::make(torch::empty({4, 64, 8, 8}, torch::kFloat64), weight),
              nullptr);
}

TEST(Winograd, GivesTheSameOnOneThreadAndOnMany) {
    if (!runs_here(torch::kFloat32)) GTEST_SKIP() << "no instructions for it";
    const Convolutions layer(64, 128, torch::kFloat32);
    const WinogradConvolution fast(layer.weight, torch::kFloat32);
    const torch::Tensor x = torch::randn({1, 64, 40, 24});
    const torch::Tensor one = fast.forward(x, layer.bias);
    at::set_num_threads(5);  // more than there are ranges of tiles
    const torch::Tensor many = fast.forward(x, layer.bias);
    at::set_num_threads(1);
    EXPECT_TRUE(torch::equal(one, many));
}

TEST(Conv3x3, FollowsItsWeightsAndTheirGradients) {
    Conv3x3 layer(64, 64);
    const auto expect_as_direct = [&](const torch::Tensor& x) {
        const torch::Tensor exact =
            torch::conv2d(x.to(torch::kFloat64), layer->weight.to(torch::kFloat64),
                          layer->bias.to(torch::kFloat64), 1, 1);
        EXPECT_LT(relative_error(layer(x), exact), 2e-6);
    };
    const torch::Tensor x = torch::randn({2, 64, 16, 16});
    layer(x).square().mean().backward();
    EXPECT_TRUE(layer->weight.grad().defined()) << "weights that ask for a gradient get one";

    for (torch::Tensor& parameter : layer->parameters())
        parameter.set_requires_grad(false);
    expect_as_direct(x);
    {
        const torch::NoGradGuard no_grad;
        layer->weight.mul_(2);
    }
    expect_as_direct(x);
    layer->weight.set_data(torch::randn_like(layer->weight));
    expect_as_direct(x);
    expect_as_direct(x.slice(2, 0, 4));  // too few pixels to gain

    const torch::Tensor asking = x.clone().requires_grad_(true);
    layer(asking).square().sum().backward();
    const torch::Tensor same = x.clone().requires_grad_(true);
    torch::conv2d(same, layer->weight, layer->bias, 1, 1).square().sum().backward();
    EXPECT_LT(relative_error(asking.grad(), same.grad().to(torch::kFloat64)), 2e-6);
}

TEST(Conv3x3, RunsWithoutTheWeightsThatItGaveUp) {
    if (!runs_here(torch::kBFloat16)) GTEST_SKIP() << "no instructions for bfloat16";
    const auto output_and_gradient = [](Conv3x3& layer) {
        torch::manual_seed(3);
        const torch::Tensor x =
            torch::randn({2, 128, 16, 16}).to(torch::kBFloat16).requires_grad_(true);
        const torch::Tensor y = layer(x);
        return std::pair(y.detach(), torch::autograd::grad({y}, {x}, {torch::randn_like(y)})[0]);
    };
    Conv3x3 layer(128, 64);
    for (torch::Tensor& parameter : layer->parameters()) {
        parameter.set_requires_grad(false);
        parameter.set_data(parameter.to(torch::kBFloat16));
    }
    const auto before = output_and_gradient(layer);
    layer->give_up_weights();
    const auto after = output_and_gradient(layer);
    EXPECT_EQ(layer->weight.numel(), 0);
    EXPECT_TRUE(torch::equal(after.first, before.first));
    EXPECT_TRUE(torch::equal(after.second, before.second));
    const torch::Tensor x = torch::randn({2, 128, 16, 16}).to(torch::kBFloat16);
    // Pictures that would not have been worth it are convolved the same way now.
    EXPECT_TRUE(torch::allclose(layer(x.slice(2, 0, 4)).slice(2, 0, 3), layer(x).slice(2, 0, 3)));
}

/// A layer that asks for no gradient of its weights.
Conv3x3 frozen_layer(int in, int out, torch::Dtype dtype) {
    torch::manual_seed(in);
    Conv3x3 layer(in, out);
    for (torch::Tensor& parameter : layer->parameters()) {
        parameter.set_requires_grad(false);
        parameter.set_data(parameter.to(dtype));
    }
    return layer;
}

void compare_from_file(torch::Dtype dtype) {
    for (const int in : {128, 24}) {  // packed, and left to the library
        Conv3x3 layer = frozen_layer(in, 64, dtype), from_file = frozen_layer(in, 64, dtype);
        const torch::Tensor stored = torch::randn({64, in, 3, 3}).to(torch::kFloat16);
        layer->weight.set_data(stored.to(dtype).contiguous(torch::MemoryFormat::ChannelsLast));
        int forgotten = 0;
        from_file->run_from(stored, [&] { ++forgotten; });
        for (const int side : {16, 4}) {
            const torch::Tensor x =
                torch::randn({2, in, side, side}).to(dtype).requires_grad_(true);
            const torch::Tensor y = layer(x), same = from_file(x), way = torch::randn_like(y);
            EXPECT_TRUE(torch::equal(y, same));
            EXPECT_TRUE(torch::equal(torch::autograd::grad({y}, {x}, {way})[0],
                                     torch::autograd::grad({same}, {x}, {way})[0]));
        }
        EXPECT_GE(forgotten, 1) << in << " channels";
    }
}

TEST(Conv3x3, RunsFromTheWeightsOfAFile) {
    for (const torch::Dtype dtype : {torch::kFloat32, torch::kBFloat16})
        if (runs_here(dtype)) compare_from_file(dtype);
}

TEST(FrozenConvolution, TurnsLargeWeightsRoundEachTime) {
    if (!runs_here(torch::kBFloat16)) GTEST_SKIP() << "no instructions for bfloat16";
    // 5.3 MB and 3 MB of packed weights: those that are kept are turned by the same code.
    compare<WinogradConvolution>(torch::kBFloat16, {1, 384, 8, 8}, 448, 3.0);
    compare<DirectConvolution>(torch::kBFloat16, {1, 640, 4, 4}, 512, 1.1);
    compare<DirectConvolution>(torch::kFloat32, {1, 320, 4, 4}, 512, 8);
}

TEST(Downsample, HasTheLibrarysGradientWithoutKeepingItsInput) {
    for (const int padding : {0, 1}) {
        torch::manual_seed(1);
        Downsample down(8, padding);
        const torch::Tensor x = torch::randn({2, 8, 9, 12}).requires_grad_(true);
        const torch::Tensor y = down(x), way = torch::randn_like(y);
        const torch::Tensor exact = torch::autograd::grad({y}, {x}, {way})[0];
        for (torch::Tensor& parameter : down->parameters())
            parameter.set_requires_grad(false);
        const torch::Tensor frozen = down(x);
        EXPECT_TRUE(torch::allclose(frozen, y, 1e-5, 1e-6));
        EXPECT_TRUE(
            torch::allclose(torch::autograd::grad({frozen}, {x}, {way})[0], exact, 1e-5, 1e-6));
    }
}

}  // namespace
}  // namespace item3d
