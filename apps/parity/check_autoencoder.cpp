#include "apps/parity/parity.h"
#include "item3d/core/error.h"
#include "item3d/networks/diffusion/autoencoder.h"
#include "item3d/networks/diffusion/autoencoder_kl.h"

#include <torch/csrc/autograd/autograd.h>

namespace item3d::parity {
namespace {

at::Tensor gradient(const at::Tensor& output, const at::Tensor& cotangent,
                    const at::Tensor& input) {
    return torch::autograd::grad({(output * cotangent).sum()}, {input}, {},
                                 /*retain_graph=*/true)[0];
}

void check_kl(Case& golden, const std::filesystem::path& folder, const std::string& label) {
    const auto loaded = load_autoencoder(folder);
    const auto vae = std::dynamic_pointer_cast<AutoencoderKL>(loaded);
    ITEM3D_CHECK(vae, "config.json says AutoencoderKL");
    const auto compare = [&](const std::string& name, const at::Tensor& actual) {
        golden.compare(name, actual, within::one_pass, label + name);
    };
    {
        const at::AutoGradMode with_gradients(true);
        const at::Tensor image = golden.input("image").clone().requires_grad_();
        const LatentDistribution latents = vae->encode_distribution(image);
        compare("mean", latents.mean);
        compare("logvar", latents.log_variance);
        compare("std", latents.deviation());
        if (golden.has("in.noise")) {
            const at::Tensor sample = latents.mean + latents.deviation() * golden.input("noise");
            compare("sample", sample);
            compare("scaled_sample", sample * vae->scaling_factor());
            if (golden.has("out.grad_sample"))
                compare("grad_sample", gradient(sample, golden.input("cotangent"), image));
        }
        if (golden.has("out.grad_mean"))
            compare("grad_mean", gradient(latents.mean, golden.input("cotangent"), image));
    }
    if (golden.has("out.mean_odd")) compare("mean_odd", vae->encode(golden.input("image_odd")));
    compare("decoded", vae->decode(golden.input("latents")));

    if (!label.empty()) return;
    vae->to(at::kBFloat16);
    golden.orient("mean_bf16", vae->encode(golden.input("image")), "mean");
    golden.orient("decoded_bf16", vae->decode(golden.input("latents")), "decoded");
}

}  // namespace

void check_autoencoder_kl(Case& golden) {
    check_kl(golden, golden.folder(), "");
    for (const auto& entry : std::filesystem::directory_iterator(golden.folder()))
        if (entry.is_directory() && std::filesystem::exists(entry.path() / "config.json"))
            check_kl(golden, entry.path(), entry.path().filename().string() + "/");
}

void check_autoencoder_tiny(Case& golden) {
    const auto vae = load_autoencoder(golden.folder());
    {
        const at::AutoGradMode with_gradients(true);
        const at::Tensor image = golden.input("image").clone().requires_grad_();
        const at::Tensor latents = vae->encode(image);
        golden.compare("latents", latents, within::one_pass);
        if (golden.has("out.grad_latents"))
            golden.compare("grad_latents", gradient(latents, golden.input("cotangent"), image),
                           within::one_pass);
    }
    if (golden.has("out.latents_odd"))
        golden.compare("latents_odd", vae->encode(golden.input("image_odd")), within::one_pass);
    golden.compare("decoded", vae->decode(golden.input("latents")), within::one_pass);
    vae->to(at::kBFloat16);
    golden.orient("latents_bf16", vae->encode(golden.input("image")), "latents");
    golden.orient("decoded_bf16", vae->decode(golden.input("latents")), "decoded");
}

}  // namespace item3d::parity
