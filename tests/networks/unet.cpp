#include "item3d/networks/diffusion/unet.h"

#include "item3d/core/error.h"
#include "item3d/core/files.h"
#include "item3d/networks/layers/attention.h"
#include "item3d/tensors/weights.h"
#include "tests/support/networks.h"

#include <ATen/autocast_mode.h>
#include <torch/csrc/autograd/autograd.h>

namespace item3d {
namespace {

using testing::fixture;
using testing::Golden;
using testing::largest_difference;
using testing::message_of;
using testing::TemporaryFolder;

UNet2DConditionConfig small_config() {
    return UNet2DConditionConfig::from_json(
        {{"block_out_channels", {8, 16}},
         {"down_block_types", {"CrossAttnDownBlock2D", "DownBlock2D"}},
         {"up_block_types", {"UpBlock2D", "CrossAttnUpBlock2D"}},
         {"layers_per_block", 1},
         {"attention_head_dim", 2},
         {"cross_attention_dim", 12},
         {"norm_num_groups", 4}});
}

TEST(UNet, ReproducesTheReference) {
    const at::NoGradGuard no_grad;
    const Golden golden("unet_depth");
    UNet2DCondition unet = load_unet(fixture("unet_depth"));
    const at::Tensor sample = golden.in("sample"), context = golden.in("encoder_hidden_states");
    const at::Tensor timesteps = golden.in("timesteps");
    golden.expect("sample_0", unet(sample, timesteps[0], context));
    golden.expect("sample_1", unet(sample, timesteps[1], context));
    golden.expect("sample_float_t", unet(sample, golden.in("timestep_float"), context));
    golden.expect("sample_odd",
                  unet(golden.in("sample_odd"), timesteps[1][1], context.slice(0, 0, 1)));
    const at::Tensor sinusoids = unet->time_sinusoids(timesteps[1]);
    golden.expect("time_proj", sinusoids);
    golden.expect("time_embedding", unet->time_embedding(sinusoids));
}

/// RAII guard that turns on LibTorch's automatic casts to bfloat16 on the CPU.
class Autocast {
  public:
    Autocast() {
        at::autocast::set_autocast_enabled(at::kCPU, true);
        at::autocast::set_autocast_dtype(at::kCPU, at::kBFloat16);
    }
    ~Autocast() {
        at::autocast::clear_cache();
        at::autocast::set_autocast_enabled(at::kCPU, false);
    }
    Autocast(const Autocast&) = delete;
    Autocast& operator=(const Autocast&) = delete;
};

TEST(UNet, GivesTheSameInEveryLayoutAndNearlySoInBfloat16) {
    const at::NoGradGuard no_grad;
    const Golden golden("unet_depth");
    UNet2DCondition unet = load_unet(fixture("unet_depth"));
    const at::Tensor sample = golden.in("sample"), context = golden.in("encoder_hidden_states");
    const at::Tensor timesteps = golden.in("timesteps")[0];
    golden.expect("sample_0",
                  unet(sample.contiguous(at::MemoryFormat::ChannelsLast), timesteps, context));

    const at::Tensor automatic = [&] {
        const Autocast autocast;
        return unet(sample, timesteps, context);
    }();
    EXPECT_EQ(automatic.scalar_type(), at::kBFloat16);

    const UNet2DCondition half = load_unet(fixture("unet_depth"), at::kCPU, at::kBFloat16);
    UNet2DCondition copy = half;
    const at::Tensor cast = copy(sample, timesteps, context);
    const at::Tensor wanted = golden.out("sample_0");
    for (const at::Tensor& actual : {automatic, cast})
        EXPECT_LT((actual.to(at::kFloat) - wanted).norm().item<double>(),
                  0.03 * wanted.norm().item<double>());
}

TEST(Attention, PlainAndFusedFormsAgree) {
    at::manual_seed(3);
    const at::Tensor q = at::randn({2, 5, 12}), k = at::randn({2, 7, 12}),
                     v = at::randn({2, 7, 12}), mask = at::randn({5, 7});
    for (const at::Tensor& bias : {at::Tensor(), mask}) {
        const at::Tensor plain = attention(q.clone().requires_grad_(), k, v, 3, bias);
        const at::NoGradGuard no_grad;
        EXPECT_LT(largest_difference(plain.detach(), attention(q, k, v, 3, bias)), 1e-6);
    }
}

TEST(Attention, MapsAreTheSoftmaxOnOneGrid) {
    AttentionMaps maps(2, 2);
    maps.set_layer(2, 2);
    // The layer has one head of one channel. Its second place reads only the second token.
    const at::Tensor asking = at::tensor({0.0f, 40.0f, 0.0f, 0.0f}).view({1, 4, 1});
    maps.add(asking, at::tensor({-1.0f, 1.0f}).view({1, 2, 1}), 1);
    EXPECT_LT(largest_difference(maps.mean()[0][1], at::tensor({.5f, 1.f, .5f, .5f}).view({2, 2})),
              1e-6);
    // A coarser layer reads the first token everywhere.
    maps.set_layer(1, 1);
    maps.add(at::tensor({-40.0f}).view({1, 1, 1}), at::tensor({-1.0f, 1.0f}).view({1, 2, 1}), 1);
    EXPECT_LT(
        largest_difference(maps.mean()[0][1], at::tensor({.25f, .5f, .25f, .25f}).view({2, 2})),
        1e-6);
}

TEST(UNet, GradientReachesTheTextEmbedding) {
    at::manual_seed(4);
    UNet2DCondition unet(small_config());
    unet->to(at::kDouble);
    const auto options = at::dtype(at::kDouble);
    const at::Tensor sample = at::randn({1, 4, 6, 5}, options);
    const at::Tensor context = at::randn({1, 3, 12}, options).requires_grad_();
    const at::Tensor timestep = at::tensor({400}, at::kLong),
                     weights = at::randn({1, 4, 6, 5}, options);
    const auto value = [&](const at::Tensor& text) {
        return (unet(sample, timestep, text) * weights).sum();
    };
    const at::Tensor gradient = torch::autograd::grad({value(context)}, {context})[0];
    const at::Tensor direction = at::randn({1, 3, 12}, options);
    const at::NoGradGuard no_grad;
    const double step = 1e-5;
    const double difference =
        (value(context + step * direction) - value(context - step * direction)).item<double>() /
        (2 * step);
    EXPECT_NEAR((gradient * direction).sum().item<double>(), difference,
                1e-6 * std::max(1.0, std::abs(difference)));
    EXPECT_GT(gradient.abs().max().item<double>(), 1e-6);
}

TEST(UNet, ConfigSurvivesWritingAndReading) {
    const auto config =
        UNet2DConditionConfig::from_config(Config::read(fixture("unet_depth") / "config.json"));
    const auto again = UNet2DConditionConfig::from_json(config.to_json());
    EXPECT_EQ(config.to_json(), again.to_json());
    EXPECT_EQ(again.in_channels, 5);
    EXPECT_EQ(again.attention_head_dim, (std::vector<int>{1, 2, 4}));
}

TEST(UNet, RejectsWhatItDoesNotSupportByKey) {
    const nlohmann::json good = small_config().to_json();
    const std::pair<const char*, nlohmann::json> changes[] = {
        {"act_fn", "gelu"},
        {"attention_head_dim", {3, 2}},
        {"block_out_channels", {8, -16}},
        {"class_embed_type", "timestep"},
        {"down_block_types", {"DownBlock2D"}},
        {"in_channels", "four"},
        {"norm_num_groups", 5},
        {"only_cross_attention", {false, true}},
        {"resnet_time_scale_shift", "scale_shift"},
        {"up_block_types", {"UpBlock2D", "AttnUpBlock2D"}},
    };
    for (const auto& [key, value] : changes) {
        nlohmann::json bad = good;
        bad[key] = value;
        const std::string message =
            message_of<InputError>([&] { UNet2DConditionConfig::from_json(bad, "c.json"); });
        EXPECT_NE(message.find(key), std::string::npos) << message;
        EXPECT_NE(message.find("c.json"), std::string::npos) << message;
    }
}

TEST(UNet, AConfigOfAnotherSizeIsRejectedBeforeItIsBuilt) {
    const TemporaryFolder folder;
    std::filesystem::copy(fixture("unet_depth"), folder.path(),
                          std::filesystem::copy_options::recursive);
    nlohmann::json config = Config::read(fixture("unet_depth") / "config.json").json();
    const auto load_with = [&](const std::vector<int>& channels) {
        config["block_out_channels"] = channels;
        testing::write_file(folder.path() / "config.json", config.dump());
        return message_of<InputError>([&] { load_unet(folder.path()); });
    };
    // This config has 2.4 billion parameters. Allocating them would take longer than the test.
    EXPECT_NE(load_with({16384, 16384, 16384}).find("describes a network"), std::string::npos);
    EXPECT_NE(load_with({8, 16, 24}).find("expected shape"), std::string::npos);
}

}  // namespace
}  // namespace item3d
