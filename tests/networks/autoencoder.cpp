#include "item3d/networks/diffusion/autoencoder.h"

#include "item3d/core/error.h"
#include "item3d/networks/diffusion/autoencoder_kl.h"
#include "item3d/networks/diffusion/autoencoder_tiny.h"
#include "item3d/tensors/weights.h"
#include "tests/support/networks.h"

#include <torch/csrc/autograd/autograd.h>
#include <torch/optim/adam.h>

namespace item3d {
namespace {

using testing::fixture;
using testing::Golden;
using testing::message_of;
using testing::TemporaryFolder;

at::Tensor gradient(const at::Tensor& output, const at::Tensor& cotangent,
                    const at::Tensor& input) {
    return torch::autograd::grad({(output * cotangent).sum()}, {input}, {}, true)[0];
}

TEST(AutoencoderTiny, ReproducesTheReference) {
    const Golden golden("vae_tiny");
    const auto vae = load_autoencoder(fixture("vae_tiny"));
    EXPECT_EQ(vae->downscale(), 8);
    const at::Tensor image = golden.in("image").clone().requires_grad_();
    const at::Tensor latents = vae->encode(image);
    golden.expect("latents", latents);
    golden.expect("grad_latents", gradient(latents, golden.in("cotangent"), image));
    golden.expect("latents_odd", vae->encode(golden.in("image_odd")));
    golden.expect("decoded", vae->decode(golden.in("latents")));
}

TEST(AutoencoderTiny, LearnsToReconstruct) {
    at::manual_seed(5);
    AutoencoderTinyConfig config;
    config.encoder_block_out_channels = config.decoder_block_out_channels = {16, 16};
    config.num_encoder_blocks = config.num_decoder_blocks = {1, 1};
    AutoencoderTiny vae(config);
    EXPECT_EQ(vae.downscale(), 2);
    const at::Tensor image = at::rand({4, 3, 1, 1}).expand({4, 3, 8, 8}) * 2 - 1;
    torch::optim::Adam optimizer(vae.parameters(), torch::optim::AdamOptions(5e-3));
    double first = 0, last = 0;
    for (int i = 0; i < 60; ++i) {
        const at::Tensor loss = (vae.decode(vae.encode(image)) - image).square().mean();
        optimizer.zero_grad();
        loss.backward();
        optimizer.step();
        (i == 0 ? first : last) = loss.item<double>();
    }
    EXPECT_LT(last, 0.3 * first);
}

TEST(AutoencoderKL, GivesTheSameGradientWhenItComputesAgain) {
    const Golden golden("vae_kl");
    const auto vae = load_autoencoder(fixture("vae_kl"));
    const auto gradient_of_mean = [&] {
        const at::Tensor image = golden.in("image").clone().requires_grad_();
        return gradient(vae->encode(image), golden.in("cotangent"), image);
    };
    const at::Tensor kept = gradient_of_mean();
    vae->recompute_in_backward(true);
    EXPECT_TRUE(gradient_of_mean().equal(kept));
    golden.expect("grad_mean", gradient_of_mean());
    EXPECT_FALSE(vae->encode(golden.in("image")).requires_grad());
}

TEST(AutoencoderKL, ReproducesTheReferenceAndItsGradients) {
    const Golden golden("vae_kl");
    const auto vae = std::dynamic_pointer_cast<AutoencoderKL>(load_autoencoder(fixture("vae_kl")));
    ASSERT_TRUE(vae);
    const at::Tensor image = golden.in("image").clone().requires_grad_();
    const LatentDistribution latents = vae->encode_distribution(image);
    const at::Tensor sample = latents.mean + latents.deviation() * golden.in("noise");
    golden.expect("mean", latents.mean);
    golden.expect("std", latents.deviation());
    golden.expect("sample", sample);
    golden.expect("grad_mean", gradient(latents.mean, golden.in("cotangent"), image));
    golden.expect("grad_sample", gradient(sample, golden.in("cotangent"), image));
    golden.expect("mean_odd", vae->encode(golden.in("image_odd")));
    golden.expect("decoded", vae->decode(golden.in("latents")));
}

TEST(AutoencoderKL, UnderstandsTheOldNamesOfAttentionLayers) {
    const Golden golden("vae_kl");
    const TemporaryFolder folder;
    NamedTensors renamed;
    int count = 0;
    const auto file = SafeTensors::open(fixture("vae_kl") / "diffusion_pytorch_model.safetensors");
    for (auto [name, tensor] : file.tensors()) {
        for (const auto& [now, old] :
             {std::pair(".to_q.", ".query."), std::pair(".to_k.", ".key."),
              std::pair(".to_v.", ".value."), std::pair(".to_out.0.", ".proj_attn.")}) {
            const auto at = name.find(now);
            if (at == std::string::npos) continue;
            name.replace(at, std::string(now).size(), old);
            ++count;
        }
        renamed.emplace_back(name, tensor);
    }
    EXPECT_EQ(count, 16);
    save_safetensors(folder.path() / "diffusion_pytorch_model.safetensors", renamed);
    std::filesystem::copy(fixture("vae_kl") / "config.json", folder.path());
    golden.expect("decoded", load_autoencoder(folder.path())->decode(golden.in("latents")));
}

TEST(Autoencoder, RejectsUnknownKinds) {
    const TemporaryFolder folder;
    testing::write_file(folder.path() / "config.json", R"({"_class_name":"VQModel"})");
    const std::string message = message_of<InputError>([&] { load_autoencoder(folder.path()); });
    EXPECT_NE(message.find("VQModel"), std::string::npos) << message;
    EXPECT_THROW(
        AutoencoderTinyConfig::from_config(Config({{"num_encoder_blocks", {1, 2}}}, "config.json")),
        InputError);
    EXPECT_THROW(
        AutoencoderKLConfig::from_config(Config({{"block_out_channels", {30, 64}}}, "config.json")),
        InputError);
}

}  // namespace
}  // namespace item3d
