#include "item3d/networks/layers/gated_gelu.h"

#include "tests/support/networks.h"

#include <torch/csrc/autograd/autograd.h>

namespace item3d {
namespace {

/// Compares the gate's output and gradient with those of LibTorch in float64.
void compare_gate(const std::vector<std::int64_t>& shape, at::ScalarType dtype, double tolerance) {
    SCOPED_TRACE(::testing::Message() << shape.back() << " numbers");
    at::manual_seed(shape.back());
    const at::Tensor x = (3 * at::randn(shape)).to(dtype).requires_grad_(true);
    const at::Tensor exact_x = x.detach().to(at::kDouble).requires_grad_(true);
    const auto halves = exact_x.chunk(2, -1);
    const at::Tensor exact = halves[0] * at::gelu(halves[1]);
    const at::Tensor y = gated_gelu(x), way = at::randn_like(y);
    const auto error = [](const at::Tensor& actual, const at::Tensor& wanted) {
        return ((actual.to(at::kDouble) - wanted).norm() / wanted.norm()).item<double>();
    };
    EXPECT_EQ(y.scalar_type(), dtype);
    EXPECT_LT(error(y.detach(), exact.detach()), tolerance);
    EXPECT_LT(error(torch::autograd::grad({y}, {x}, {way})[0],
                    torch::autograd::grad({exact}, {exact_x}, {way.to(at::kDouble)})[0]),
              tolerance);
}

TEST(GatedGelu, IsTheLibrarysWithItsGradient) {
    compare_gate({3, 7, 384}, at::kFloat, 1e-6);
    compare_gate({700, 32}, at::kFloat, 1e-6);
    compare_gate({2, 5, 20}, at::kFloat, 1e-6);  // computed by LibTorch
    compare_gate({2, 9, 96}, at::kBFloat16, 5e-3);
    compare_gate({2, 9, 96}, at::kDouble, 1e-12);
}

TEST(GatedGelu, StaysFiniteFarOut) {
    const at::Tensor x = at::linspace(-1e4, 1e4, 64).view({1, 64}).requires_grad_(true);
    const at::Tensor y = gated_gelu(x);
    y.sum().backward();
    EXPECT_TRUE(y.isfinite().all().item<bool>());
    EXPECT_TRUE(x.grad().isfinite().all().item<bool>());
}

}  // namespace
}  // namespace item3d
