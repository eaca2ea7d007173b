#include "item3d/networks/layers/group_norm.h"

#include "support/networks.h"

#include <torch/csrc/autograd/autograd.h>

namespace item3d {
namespace {

/// Our norm's output and gradient beside LibTorch's of float64.
void compare_norm(int groups, const std::vector<std::int64_t>& shape, torch::Dtype dtype,
                  Activation activation, double tolerance) {
    SCOPED_TRACE(::testing::Message() << shape[1] << " channels, height " << shape[2]);
    torch::manual_seed(shape[1]);
    torch::nn::GroupNorm norm(torch::nn::GroupNormOptions(groups, shape[1]).eps(1e-6));
    for (torch::Tensor& parameter : norm->parameters()) {
        parameter.set_requires_grad(false);
        parameter.set_data(torch::randn_like(parameter).to(dtype));
    }
    // Far from zero, so that a variance by the plain difference of squares would lose it.
    const torch::Tensor x = (torch::randn(shape) + 30).to(dtype).requires_grad_(true);
    const torch::Tensor exact_x = x.detach().to(torch::kFloat64).requires_grad_(true);
    torch::Tensor exact = torch::group_norm(exact_x, groups, norm->weight.to(torch::kFloat64),
                                            norm->bias.to(torch::kFloat64), 1e-6);
    if (activation == Activation::silu) exact = torch::silu(exact);
    const torch::Tensor y = group_norm(norm, x, activation);
    const torch::Tensor gradient = torch::randn(shape).to(dtype);
    const torch::Tensor dx = torch::autograd::grad({y}, {x}, {gradient})[0];
    const torch::Tensor exact_dx =
        torch::autograd::grad({exact}, {exact_x}, {gradient.to(torch::kFloat64)})[0];
    const auto error = [](const torch::Tensor& actual, const torch::Tensor& wanted) {
        return ((actual.to(torch::kFloat64) - wanted).norm() / wanted.norm()).item<double>();
    };
    EXPECT_EQ(y.scalar_type(), dtype);
    EXPECT_LT(error(y.detach(), exact.detach()), tolerance);
    EXPECT_LT(error(dx, exact_dx), tolerance);
}

TEST(GroupNorm, IsTheLibrarysWithItsGradient) {
    for (const Activation activation : {Activation::none, Activation::silu}) {
        compare_norm(4, {2, 64, 9, 7}, torch::kFloat32, activation, 1e-5);
        compare_norm(32, {1, 320, 40, 30}, torch::kFloat32, activation, 1e-5);
        compare_norm(8, {3, 16, 1, 5}, torch::kFloat32, activation, 1e-5);
        compare_norm(4, {2, 20, 6, 6}, torch::kFloat32, activation, 1e-4);  // the library's
        compare_norm(16, {2, 48, 33, 35}, torch::kBFloat16, activation, 5e-3);
    }
}

TEST(GroupNorm, KeepsSiluFiniteFarOut) {
    torch::nn::GroupNorm norm(torch::nn::GroupNormOptions(1, 16));
    norm->weight.set_requires_grad(false).fill_(1000);
    norm->bias.set_requires_grad(false);
    const torch::Tensor x = torch::randn({1, 16, 8, 8}).requires_grad_(true);
    const torch::Tensor y = group_norm(norm, x, Activation::silu);
    y.sum().backward();
    EXPECT_TRUE(y.isfinite().all().item<bool>());
    EXPECT_GE(y.min().item<double>(), -0.3);
    EXPECT_TRUE(x.grad().isfinite().all().item<bool>());
}

TEST(GroupNorm, GivesItsWeightsTheGradientsTheyAskFor) {
    torch::nn::GroupNorm norm(torch::nn::GroupNormOptions(2, 16));
    group_norm(norm, torch::randn({1, 16, 4, 4}), Activation::silu).sum().backward();
    EXPECT_TRUE(norm->weight.grad().defined());
    EXPECT_TRUE(norm->bias.grad().defined());
}

}  // namespace
}  // namespace item3d
