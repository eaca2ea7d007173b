#include "item3d/networks/layers/row_groups.h"

#include "item3d/networks/diffusion/unet.h"
#include "tests/support/networks.h"

#include <torch/csrc/autograd/autograd.h>

namespace item3d {
namespace {

/// Returns a small U-Net whose layers have the embedded prior's widths.
UNet2DCondition small_unet() {
    at::manual_seed(1);
    const std::vector<std::string> down(2, "CrossAttnDownBlock2D"), up(2, "CrossAttnUpBlock2D");
    UNet2DCondition unet(UNet2DConditionConfig::from_json({{"in_channels", 4},
                                                           {"block_out_channels", {48, 96}},
                                                           {"down_block_types", down},
                                                           {"up_block_types", up},
                                                           {"layers_per_block", 1},
                                                           {"attention_head_dim", {2, 4}},
                                                           {"cross_attention_dim", 32},
                                                           {"norm_num_groups", 16}}));
    for (at::Tensor& parameter : unet->parameters())
        parameter.set_requires_grad(false);
    return unet;
}

/// Returns a U-Net's output for some rows that share one text, and the gradient of the output's
/// squares with respect to this text.
std::pair<at::Tensor, at::Tensor> predict_rows(std::int64_t rows, bool in_groups) {
    UNet2DCondition unet = small_unet();
    at::manual_seed(2);
    const at::Tensor sample = at::randn({rows, 4, 4, 4});
    const at::Tensor text = at::randn({1, 7, 32}).requires_grad_(true);
    const at::Tensor times = at::arange(rows) * 100;
    const auto run = [&](std::int64_t first, std::int64_t count, const at::Tensor& states) {
        return unet(sample.narrow(0, first, count), times.narrow(0, first, count), states);
    };
    const at::Tensor each = text.expand({rows, 7, 32});
    const at::Tensor y = in_groups ? in_row_groups(each, run) : run(0, rows, each);
    return {y.detach(), torch::autograd::grad({y.square().mean()}, {text})[0]};
}

TEST(RowGroups, GiveWhatAllRowsTogetherGive) {
    for (const std::int64_t rows : {1, 2, 5, 33}) {
        const auto [y, gradient] = predict_rows(rows, true);
        const auto [whole, whole_gradient] = predict_rows(rows, false);
        EXPECT_TRUE(at::allclose(y, whole, 1e-4, 1e-5)) << rows;
        EXPECT_TRUE(at::allclose(gradient, whole_gradient, 1e-3,
                                 1e-4 * whole_gradient.abs().max().item<double>()))
            << rows;
    }
}

TEST(RowGroups, GiveTheSameOnOneThreadAndOnMany) {
#if defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "the loop's threads are not OpenMP's, so MKL divides a product among threads";
#endif
    at::set_num_threads(1);
    const auto one = predict_rows(7, true);
    at::set_num_threads(4);
    const auto many = predict_rows(7, true);
    at::set_num_threads(testing::test_threads());
    EXPECT_TRUE(at::equal(one.first, many.first));
    EXPECT_TRUE(at::equal(one.second, many.second));
}

TEST(RowGroups, KeepNoGraphWhereNoGradientIsAskedFor) {
    const at::Tensor text = at::randn({5, 3});
    const RowFunction doubled = [&](auto, auto, const at::Tensor& rows) {
        EXPECT_FALSE(at::GradMode::is_enabled());
        return rows * 2;
    };
    EXPECT_TRUE(at::equal(in_row_groups(text, doubled), text * 2));
    const at::Tensor asking = at::randn({5, 3}).requires_grad_(true);
    const at::NoGradGuard no_grad;
    EXPECT_FALSE(in_row_groups(asking, doubled).requires_grad());
}

TEST(RowGroups, PassOnWhatIsThrown) {
    const RowFunction fails = [](std::int64_t first, std::int64_t, const at::Tensor& rows) {
        if (first > 0) throw std::runtime_error("no");
        return rows;
    };
    EXPECT_THROW(in_row_groups(at::zeros({6, 2}), fails), std::runtime_error);
}

}  // namespace
}  // namespace item3d
