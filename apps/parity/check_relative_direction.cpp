// The check of one step of the relative direction. It compares the recorded form with four rows,
// for both bases of the source branch, and the form with two rows that the program uses, which
// equals the form with the right base.
#include "apps/parity/parity.h"
#include "item3d/core/error.h"
#include "item3d/guidance/noised_latents.h"
#include "item3d/guidance/rdl.h"
#include "item3d/networks/diffusion/autoencoder_kl.h"
#include "item3d/networks/diffusion/diffusion_networks.h"
#include "item3d/networks/diffusion/pipeline.h"

#include <torch/csrc/autograd/autograd.h>

namespace item3d::parity {

void check_relative_direction(Case& golden) {
    const Config meta = golden.meta();
    const Pipeline pipeline = Pipeline::load(golden.folder() / meta.text("pipeline", ""));
    const auto vae = std::dynamic_pointer_cast<AutoencoderKL>(pipeline.networks().vae);
    if (!vae) meta.reject("pipeline", "expected one with an AutoencoderKL");
    const double scale = meta.number("guidance", 7.5);
    const auto compare = [&](const std::string& name, const at::Tensor& actual) {
        golden.compare(name, actual, within::guidance_step);
    };

    at::Tensor image, latents;
    {
        const at::AutoGradMode with_gradients(true);
        image = golden.input("image").clone().requires_grad_();
        const LatentDistribution posterior = vae->encode_distribution(2 * image - 1);
        latents = (posterior.mean + posterior.deviation() * golden.input("posterior_noise")) *
                  vae->scaling_factor();
    }
    const at::Tensor timesteps = golden.input("t");
    NoisedLatents start;
    start.timesteps = timesteps;
    start.alphas_cumprod = pipeline.schedule().alphas_at(timesteps);
    start.noisy = pipeline.schedule().add_noise(latents.detach(), golden.input("noise"), timesteps);
    compare("latents", latents);
    compare("noisy_latents", start.noisy);

    const TextEmbedding text = pipeline.encode_text(
        {meta.text("negative_text", ""), meta.text("text", ""), meta.text("ori_text", "")});
    const auto predict = [&](int row) {
        return pipeline.predict_noise(start.noisy, timesteps, text.row(row));
    };
    const at::Tensor empty = predict(0), target = predict(1), source = predict(2);
    compare("eps_uncond", empty);
    compare("eps_target_cond", target);
    compare("eps_source_cond", source);
    const at::Tensor guided_target = empty + scale * (target - empty);
    compare("eps_target", guided_target);

    const auto compare_gradient = [&](const std::string& suffix, const at::Tensor& direction) {
        for (const auto& [name, weighting] :
             {std::pair("_early", Weighting::early), std::pair("_late", Weighting::late)}) {
            const at::Tensor gradient =
                timestep_weight(weighting, start.alphas_cumprod) * direction;
            compare("grad_latents" + suffix + name, gradient);
            compare("grad_image" + suffix + name,
                    torch::autograd::grad({latents}, {image}, {gradient}, true)[0]);
        }
    };
    for (const auto& [suffix, base] : {std::pair("_uncond", empty), std::pair("_text", source)}) {
        const at::Tensor guided_source = base + scale * (source - empty);
        compare(std::string("eps_source_base") + suffix, guided_source);
        compare_gradient(suffix, guided_target - guided_source);
    }

    const PromptPair pair = predict_pair(pipeline, start, text.row(1), text.row(2));
    const at::Tensor direction = scale * (pair.target - pair.source);
    for (const auto& [name, weighting] : {std::pair("grad_latents_uncond_early", Weighting::early),
                                          std::pair("grad_latents_uncond_late", Weighting::late)})
        golden.compare(name, timestep_weight(weighting, start.alphas_cumprod) * direction,
                       within::guidance_step, std::string("two-row ") + name);
}

}  // namespace item3d::parity
