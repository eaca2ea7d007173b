#include "item3d/metrics/detail.h"

#include <gtest/gtest.h>

namespace item3d {
namespace {

/// Returns vertical stripes between two colours, [2, 3, 64, 64].
at::Tensor stripes(const std::vector<float>& a, const std::vector<float>& b) {
    const at::Tensor bright =
        (at::arange(64).div(8, "floor").remainder(2) == 0).to(at::kFloat).view({1, 1, 1, 64});
    const at::Tensor one = at::tensor(a).view({1, 3, 1, 1});
    const at::Tensor two = at::tensor(b).view({1, 3, 1, 1});
    return (bright * one + (1 - bright) * two).expand({2, 3, 64, 64}).contiguous();
}

at::Tensor disc_mask() {
    const at::Tensor x = (at::arange(64) - 31.5).square();
    return (x.view({1, 64, 1}) + x.view({1, 1, 64}) < 28 * 28).to(at::kFloat).expand({2, 64, 64});
}

TEST(DetailCorrelation, StripesThatChangeColourAreKept) {
    const at::Tensor red = stripes({0.8f, 0.1f, 0.1f}, {0.9f, 0.9f, 0.9f});
    const at::Tensor blue = stripes({0.1f, 0.2f, 0.7f}, {0.9f, 0.9f, 0.9f});
    EXPECT_NEAR(detail_correlation(red, red, disc_mask()), 1, 1e-9);
    EXPECT_GT(detail_correlation(red, blue, disc_mask()), 0.99);
}

TEST(DetailCorrelation, StripesThatVanishOrSwapAreNot) {
    const at::Tensor red = stripes({0.8f, 0.1f, 0.1f}, {0.9f, 0.9f, 0.9f});
    const at::Tensor swapped = stripes({0.9f, 0.9f, 0.9f}, {0.8f, 0.1f, 0.1f});
    const at::Tensor plain = at::full({2, 3, 64, 64}, 0.4f);
    EXPECT_LT(detail_correlation(red, swapped, disc_mask()), -0.95);
    EXPECT_EQ(detail_correlation(red, plain, disc_mask()), 0);
    at::manual_seed(1);
    EXPECT_NEAR(detail_correlation(red, at::rand({2, 3, 64, 64}), disc_mask()), 0, 0.1);
}

TEST(DetailCorrelation, SlowShadingDoesNotCountAndOutsideDoesNotEither) {
    at::manual_seed(2);
    const at::Tensor red = stripes({0.8f, 0.1f, 0.1f}, {0.9f, 0.9f, 0.9f});
    const at::Tensor ramp = at::linspace(0.4f, 1.0f, 64).view({1, 1, 64, 1});
    EXPECT_GT(detail_correlation(red, red * ramp, disc_mask()), 0.95);
    const at::Tensor inside = disc_mask().unsqueeze(1);
    const at::Tensor noise = at::rand({2, 3, 64, 64});
    EXPECT_NEAR(detail_correlation(red * inside + noise * (1 - inside), red, disc_mask()), 1, 1e-6);
    EXPECT_EQ(detail_correlation(red, red, at::zeros({2, 64, 64})), 0);
}

TEST(DetailStrength, GrowsWithContrast) {
    const double weak =
        detail_strength(stripes({0.5f, 0.5f, 0.5f}, {0.55f, 0.55f, 0.55f}), disc_mask());
    const double strong =
        detail_strength(stripes({0.2f, 0.2f, 0.2f}, {0.9f, 0.9f, 0.9f}), disc_mask());
    EXPECT_GT(weak, 0.01);
    EXPECT_GT(strong, 5 * weak);
}

}  // namespace
}  // namespace item3d
