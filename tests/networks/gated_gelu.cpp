#include "item3d/networks/layers/gated_gelu.h"

#include "support/networks.h"

#include <torch/csrc/autograd/autograd.h>

namespace item3d {
namespace {

/// The gate's output and gradient beside LibTorch's of float64.
void compare_gate(const std::vector<std::int64_t>& shape, torch::Dtype dtype, double tolerance) {
    SCOPED_TRACE(::testing::Message() << shape.back() << " numbers");
    torch::manual_seed(shape.back());
    const torch::Tensor x = (3 * torch::randn(shape)).to(dtype).requires_grad_(true);
    const torch::Tensor exact_x = x.detach().to(torch::kFloat64).requires_grad_(true);
    const auto halves = exact_x.chunk(2, -1);
    const torch::Tensor exact = halves[0] * torch::gelu(halves[1]);
    const torch::Tensor y = gated_gelu(x), way = torch::randn_like(y);
    const auto error = [](const torch::Tensor& actual, const torch::Tensor& wanted) {
        return ((actual.to(torch::kFloat64) - wanted).norm() / wanted.norm()).item<double>();
    };
    EXPECT_EQ(y.scalar_type(), dtype);
    EXPECT_LT(error(y.detach(), exact.detach()), tolerance);
    EXPECT_LT(error(torch::autograd::grad({y}, {x}, {way})[0],
                    torch::autograd::grad({exact}, {exact_x}, {way.to(torch::kFloat64)})[0]),
              tolerance);
}

TEST(GatedGelu, IsTheLibrarysWithItsGradient) {
    compare_gate({3, 7, 384}, torch::kFloat32, 1e-6);
    compare_gate({700, 32}, torch::kFloat32, 1e-6);
    compare_gate({2, 5, 20}, torch::kFloat32, 1e-6);  // the library's
    compare_gate({2, 9, 96}, torch::kBFloat16, 5e-3);
    compare_gate({2, 9, 96}, torch::kFloat64, 1e-12);
}

TEST(GatedGelu, StaysFiniteFarOut) {
    const torch::Tensor x = torch::linspace(-1e4, 1e4, 64).view({1, 64}).requires_grad_(true);
    const torch::Tensor y = gated_gelu(x);
    y.sum().backward();
    EXPECT_TRUE(y.isfinite().all().item<bool>());
    EXPECT_TRUE(x.grad().isfinite().all().item<bool>());
}

}  // namespace
}  // namespace item3d
