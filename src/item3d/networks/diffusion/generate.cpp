#include "item3d/networks/diffusion/generate.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/networks/diffusion/samplers/sampler.h"
#include "item3d/processes/shared_rows.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace item3d {
namespace {

/// First random stream for the noise of kept cells (GenerateOptions::keep). Lower streams are for
/// the sampler's steps.
constexpr int first_kept = 1 << 20;

/// Returns noise from a separate random stream for each image and step, so that an image does not
/// depend on the number of images. Step 0 gives the initial noise; higher steps give the noise of
/// the sampler's steps.
at::Tensor noise_like(const at::Tensor& latents, std::uint64_t seed, int step) {
    at::Tensor noise = at::empty(latents.sizes(), at::kFloat);
    const std::int64_t count = noise.size(0);
    const std::int64_t each = noise.numel() / count;
    for (std::int64_t i = 0; i < count; ++i) {
        Random random(seed,
                      static_cast<std::uint64_t>(i) + (static_cast<std::uint64_t>(step) << 32));
        float* values = noise.data_ptr<float>() + i * each;
        for (std::int64_t j = 0; j < each; ++j)
            values[j] = static_cast<float>(random.normal());
    }
    return noise.to(latents.device());
}

/// Returns uninitialised latents of the requested size.
at::Tensor empty_latents(const DiffusionModel& model, const GenerateOptions& options) {
    const int cell = model.downscale();
    const int native = model.native_size();
    const int width = options.width > 0 ? options.width : native;
    const int height = options.height > 0 ? options.height : native;
    if (width % cell != 0 || height % cell != 0)
        throw InputError(fmt::format("size {}x{}", width, height),
                         fmt::format("this model requires multiples of {}", cell));
    return at::empty({options.count, model.latent_channels(), height / cell, width / cell},
                     model.device());
}

/// Throws InputError for a scheduler or a number of steps that the model does not support.
NoiseSchedule choose_schedule(const DiffusionModel& model, const GenerateOptions& options) {
    SchedulerConfig config = model.schedule().config();
    if (!options.scheduler.empty()) config = config.with_sampler(options.scheduler);
    if (options.steps < 1 || options.steps > max_steps(config))
        throw InputError(fmt::format("{} steps", options.steps),
                         fmt::format("this model supports 1 to {}", max_steps(config)));
    return NoiseSchedule(config);
}

/// Number of steps to skip, so that only the fraction `strength` of the schedule runs.
int skipped_steps(const GenerateOptions& options) {
    if (!options.image.defined()) return 0;
    const auto walked = static_cast<int>(std::lround(options.steps * options.strength));
    return options.steps - std::clamp(walked, 0, options.steps);
}

at::Tensor starting_latents(const DiffusionModel& model, const GenerateOptions& options,
                            const Sampler& sampler) {
    if (options.image.defined()) {
        const at::Tensor image = options.image.to(model.device(), at::kFloat);
        return sampler.add_noise(0, image, noise_like(image, options.seed, 0));
    }
    const at::Tensor noise = options.latents.defined()
                                 ? options.latents.to(model.device(), at::kFloat)
                                 : noise_like(empty_latents(model, options), options.seed, 0);
    return noise * sampler.initial_scale();
}

/// Restores the kept cells of the image, with the noise level at which step i of the sampler
/// starts, or without noise if there is no sampler.
void keep_image(const GenerateOptions& options, const Sampler* sampler, int i,
                at::Tensor& latents) {
    if (!options.keep.defined()) return;
    ITEM3D_CHECK(options.image.defined(), "a kept part needs an image");
    const at::Tensor mask = options.keep.to(latents.device(), at::kFloat);
    at::Tensor image = options.image.to(latents.device(), at::kFloat);
    if (sampler)
        image = sampler->add_noise(i, image, noise_like(image, options.seed, first_kept + i));
    latents = image * mask + latents * (1 - mask);
}

/// Returns the batch elements [first, first + count) of `all`; undefined if `all` is undefined.
at::Tensor narrow(const at::Tensor& all, std::int64_t first, std::int64_t count) {
    return all.defined() ? all.narrow(0, first, count) : all;
}

/// Classifier-free guidance (Ho and Salimans 2022), which combines the network's outputs with and
/// without the prompt.
class GuidedNetwork {
  public:
    GuidedNetwork(const DiffusionModel& model, const GenerateOptions& options, std::int64_t rows,
                  const at::Tensor& condition)
        : model_(model),
          processes_(options.processes),
          scale_(options.guidance_scale),
          text_(model.encode_text({options.prompt}).expand(rows)) {
        if (condition.defined())
            condition_ = condition.to(model.device()).expand({rows, -1, -1, -1});
        if (!guided()) return;
        const TextEmbedding without = options.negative_prompt
                                          ? model.encode_text({*options.negative_prompt})
                                          : model.encode_no_text();
        text_ = TextEmbedding::join(without.expand(rows), text_);
        if (condition_.defined()) condition_ = at::cat({condition_, condition_});
    }

    at::Tensor operator()(const at::Tensor& latents, double timestep) const {
        const at::Tensor input = guided() ? at::cat({latents, latents}) : latents;
        const at::Tensor timesteps =
            at::full({input.size(0)}, timestep, at::kFloat).to(latents.device());
        const at::Tensor output = compute_rows(
            processes_, input.size(0), input.sizes().slice(1), latents.options(),
            [&](std::int64_t first, std::int64_t count) {
                return model_.predict(
                    narrow(input, first, count), narrow(timesteps, first, count),
                    {narrow(text_.states, first, count), narrow(text_.pooled, first, count)},
                    narrow(condition_, first, count));
            });
        if (!guided()) return output;
        const auto halves = output.chunk(2);
        return halves[0] + scale_ * (halves[1] - halves[0]);
    }

  private:
    bool guided() const { return scale_ != 1.0f; }

    const DiffusionModel& model_;
    const ProcessGroup& processes_;
    float scale_;
    TextEmbedding text_;
    at::Tensor condition_;
};

}  // namespace

at::Tensor generate_latents(const DiffusionModel& model, const GenerateOptions& options,
                            const at::Tensor& condition) {
    const at::NoGradGuard no_grad;
    ITEM3D_CHECK(options.count >= 1, "count must be at least 1");
    const NoiseSchedule schedule = choose_schedule(model, options);
    const int skipped = skipped_steps(options);
    if (skipped == options.steps) return options.image.to(model.device(), at::kFloat);
    const auto sampler = make_sampler(schedule, {options.steps, skipped, options.eta});
    at::Tensor latents = starting_latents(model, options, *sampler);
    const GuidedNetwork network(model, options, latents.size(0), condition);

    std::optional<Progress> progress;
    if (options.show_progress) progress.emplace("generate", sampler->steps());
    for (int i = 0; i < sampler->steps(); ++i) {
        keep_image(options, sampler.get(), i, latents);
        const at::Tensor output = network(sampler->scale_input(i, latents), sampler->timestep(i));
        const at::Tensor fresh = sampler->draws_noise(i)
                                     ? noise_like(latents, options.seed, skipped + i + 1)
                                     : at::Tensor();
        latents = sampler->step(i, output, latents, fresh);
        if (progress) progress->update(i + 1);
        if (interrupted()) throw Interrupted("while generating images");
    }
    keep_image(options, nullptr, 0, latents);
    return latents;
}

at::Tensor generate(const DiffusionModel& model, const GenerateOptions& options,
                    const at::Tensor& condition) {
    const at::NoGradGuard no_grad;
    const at::Tensor images = model.decode_image(generate_latents(model, options, condition));
    return (images / 2 + 0.5).clamp(0, 1).permute({0, 2, 3, 1}).contiguous();
}

}  // namespace item3d
