#include "item3d/baselines/masked_sampling.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"
#include "item3d/networks/diffusion/samplers/sampler.h"

#include <algorithm>
#include <cmath>

namespace item3d {

GuidedModel::GuidedModel(const DiffusionModel& network, const std::string& prompt,
                         const std::string& negative_prompt, float guidance_scale)
    : model(network),
      text(network.encode_text({prompt})),
      without(negative_prompt.empty() ? network.encode_no_text()
                                      : network.encode_text({negative_prompt})),
      scale(guidance_scale) {}

at::Tensor GuidedModel::operator()(const at::Tensor& latents, double timestep) const {
    const std::int64_t rows = latents.size(0);
    const at::Tensor input = at::cat({latents, latents});
    const at::Tensor timesteps = at::full({2 * rows}, timestep, latents.options());
    at::Tensor told = condition;
    if (told.defined() && told.size(0) == rows) told = at::cat({told, told});
    const at::Tensor output = model.predict(
        input, timesteps, TextEmbedding::join(without.expand(rows), text.expand(rows)), told);
    const auto halves = output.chunk(2);
    return halves[0] + scale * (halves[1] - halves[0]);
}

at::Tensor inpainting_condition(const at::Tensor& mask, const at::Tensor& masked_latents) {
    return at::cat({mask, masked_latents}, 1);
}

bool is_inpainter(const DiffusionModel& model) {
    return model.condition_channels() == 1 + model.latent_channels();
}

Random seeded_random(std::uint64_t seed, BaselineDraw draw, std::uint64_t index) {
    return Random(seed, RandomStream::baseline, (static_cast<std::uint64_t>(draw) + index) << 32);
}

at::Tensor seeded_noise(at::IntArrayRef sizes, std::uint64_t seed, BaselineDraw draw,
                        std::uint64_t index) {
    at::Tensor noise = at::empty(sizes, at::kFloat);
    Random random = seeded_random(seed, draw, index);
    float* values = noise.data_ptr<float>();
    for (std::int64_t i = 0; i < noise.numel(); ++i)
        values[i] = static_cast<float>(random.normal());
    return noise;
}

at::Tensor sample_masked(const GuidedModel& model, const MaskedSampling& sampling) {
    const at::NoGradGuard no_grad;
    const NoiseSchedule schedule(model.model.schedule().config().with_sampler(sampling.sampler));
    const auto walked = static_cast<int>(std::lround(sampling.steps * sampling.strength));
    const int skip = sampling.steps - std::clamp(walked, 1, sampling.steps);
    const auto sampler = make_sampler(schedule, {sampling.steps, skip, sampling.eta});
    const bool from_noise = skip == 0;
    at::Tensor latents = from_noise ? sampling.noise * sampler->initial_scale()
                                    : sampler->add_noise(0, sampling.image, sampling.noise);
    for (int i = 0; i < sampler->steps(); ++i) {
        if (sampling.drawn && !(i == 0 && from_noise)) {
            const at::Tensor drawn = sampling.drawn(i);
            latents = drawn * latents +
                      (1 - drawn) * sampler->add_noise(i, sampling.image, sampling.noise);
        }
        const bool inpaints =
            sampling.inpainter != nullptr && (!sampling.inpaints || sampling.inpaints(i));
        const at::Tensor output = (inpaints ? *sampling.inpainter : model)(
            sampler->scale_input(i, latents), sampler->timestep(i));
        const at::Tensor fresh =
            sampler->draws_noise(i)
                ? seeded_noise(latents.sizes(), sampling.seed, BaselineDraw::view_steps,
                               static_cast<std::uint64_t>(i))
                      .to(latents.device())
                : at::Tensor();
        latents = sampler->step(i, output, latents, fresh);
        if (interrupted()) throw Interrupted("while painting a view");
    }
    if (!sampling.drawn) return latents;
    const at::Tensor drawn = sampling.drawn(sampler->steps() - 1);
    return drawn * latents + (1 - drawn) * sampling.image;
}

}  // namespace item3d
