#include "item3d/networks/layers/group_norm.h"

#include "tests/support/networks.h"

#include <torch/csrc/autograd/autograd.h>

namespace item3d {
namespace {

/// Compares our norm's output and gradient with those of LibTorch in float64.
void compare_norm(int groups, const std::vector<std::int64_t>& shape, at::ScalarType dtype,
                  Activation activation, double tolerance) {
    SCOPED_TRACE(::testing::Message() << shape[1] << " channels, height " << shape[2]);
    at::manual_seed(shape[1]);
    torch::nn::GroupNorm norm(torch::nn::GroupNormOptions(groups, shape[1]).eps(1e-6));
    for (at::Tensor& parameter : norm->parameters()) {
        parameter.set_requires_grad(false);
        parameter.set_data(at::randn_like(parameter).to(dtype));
    }
    // The values are far from zero, where a variance by a difference of squares would lose its
    // precision.
    const at::Tensor x = (at::randn(shape) + 30).to(dtype).requires_grad_(true);
    const at::Tensor exact_x = x.detach().to(at::kDouble).requires_grad_(true);
    at::Tensor exact = at::group_norm(exact_x, groups, norm->weight.to(at::kDouble),
                                      norm->bias.to(at::kDouble), 1e-6);
    if (activation == Activation::silu) exact = at::silu(exact);
    const at::Tensor y = group_norm(norm, x, activation);
    const at::Tensor gradient = at::randn(shape).to(dtype);
    const at::Tensor dx = torch::autograd::grad({y}, {x}, {gradient})[0];
    const at::Tensor exact_dx =
        torch::autograd::grad({exact}, {exact_x}, {gradient.to(at::kDouble)})[0];
    const auto error = [](const at::Tensor& actual, const at::Tensor& wanted) {
        return ((actual.to(at::kDouble) - wanted).norm() / wanted.norm()).item<double>();
    };
    EXPECT_EQ(y.scalar_type(), dtype);
    EXPECT_LT(error(y.detach(), exact.detach()), tolerance);
    EXPECT_LT(error(dx, exact_dx), tolerance);
}

TEST(GroupNorm, IsTheLibrarysWithItsGradient) {
    for (const Activation activation : {Activation::none, Activation::silu}) {
        compare_norm(4, {2, 64, 9, 7}, at::kFloat, activation, 1e-5);
        compare_norm(32, {1, 320, 40, 30}, at::kFloat, activation, 1e-5);
        compare_norm(8, {3, 16, 1, 5}, at::kFloat, activation, 1e-5);
        compare_norm(4, {2, 20, 6, 6}, at::kFloat, activation, 1e-4);  // computed by LibTorch
        compare_norm(16, {2, 48, 33, 35}, at::kBFloat16, activation, 5e-3);
    }
}

TEST(GroupNorm, KeepsSiluFiniteFarOut) {
    torch::nn::GroupNorm norm(torch::nn::GroupNormOptions(1, 16));
    norm->weight.set_requires_grad(false).fill_(1000);
    norm->bias.set_requires_grad(false);
    const at::Tensor x = at::randn({1, 16, 8, 8}).requires_grad_(true);
    const at::Tensor y = group_norm(norm, x, Activation::silu);
    y.sum().backward();
    EXPECT_TRUE(y.isfinite().all().item<bool>());
    EXPECT_GE(y.min().item<double>(), -0.3);
    EXPECT_TRUE(x.grad().isfinite().all().item<bool>());
}

TEST(GroupNorm, GivesItsWeightsTheGradientsTheyAskFor) {
    torch::nn::GroupNorm norm(torch::nn::GroupNormOptions(2, 16));
    group_norm(norm, at::randn({1, 16, 4, 4}), Activation::silu).sum().backward();
    EXPECT_TRUE(norm->weight.grad().defined());
    EXPECT_TRUE(norm->bias.grad().defined());
}

}  // namespace
}  // namespace item3d
