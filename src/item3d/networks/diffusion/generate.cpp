// Pictures from a prompt: generate() of pipeline.h.
#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/core/progress.h"
#include "item3d/core/random.h"
#include "item3d/networks/diffusion/pipeline.h"
#include "item3d/networks/diffusion/samplers/sampler.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace item3d {
namespace {

/// Of the noise on what stays (GenerateOptions::keep); below it is the steps' own.
constexpr int first_kept = 1 << 20;

/// A stream for each picture: it does not change when more of them are asked for. Stream 0 of a
/// picture is what it starts from, the others belong to the steps.
torch::Tensor noise_like(const torch::Tensor& latents, std::uint64_t seed, int step) {
    torch::Tensor noise = torch::empty(latents.sizes(), torch::kFloat32);
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

/// Latents of the size that is asked for, without content.
torch::Tensor empty_latents(const Pipeline& pipeline, const GenerateOptions& options) {
    const int cell = pipeline.downscale();
    const int native = pipeline.unet->config().sample_size * cell;
    const int width = options.width > 0 ? options.width : native;
    const int height = options.height > 0 ? options.height : native;
    if (width % cell != 0 || height % cell != 0)
        throw InputError(fmt::format("size {}x{}", width, height),
                         fmt::format("this model makes sizes that are multiples of {}", cell));
    return torch::empty({options.count, pipeline.latent_channels(), height / cell, width / cell},
                        pipeline.device());
}

/// Throws InputError for a scheduler or a number of steps that the model cannot do.
NoiseSchedule choose_schedule(const Pipeline& pipeline, const GenerateOptions& options) {
    SchedulerConfig config = pipeline.scheduler.config();
    if (!options.scheduler.empty()) config = config.with_sampler(options.scheduler);
    if (options.steps < 1 || options.steps > most_steps(config))
        throw InputError(fmt::format("{} steps", options.steps),
                         fmt::format("this model takes 1 to {}", most_steps(config)));
    return NoiseSchedule(config);
}

/// How many of the steps are left out, so that no more of a picture is forgotten than was asked.
int skipped_steps(const GenerateOptions& options) {
    if (!options.image.defined()) return 0;
    const auto walked = static_cast<int>(std::lround(options.steps * options.strength));
    return options.steps - std::clamp(walked, 0, options.steps);
}

torch::Tensor starting_latents(const Pipeline& pipeline, const GenerateOptions& options,
                               const Sampler& sampler) {
    if (options.image.defined()) {
        const torch::Tensor image = options.image.to(pipeline.device(), torch::kFloat32);
        return sampler.add_noise(0, image, noise_like(image, options.seed, 0));
    }
    const torch::Tensor noise = options.latents.defined()
                                    ? options.latents.to(pipeline.device(), torch::kFloat32)
                                    : noise_like(empty_latents(pipeline, options), options.seed, 0);
    return noise * sampler.initial_scale();
}

/// Puts back what stays of the picture, with the noise that step i of the sampler starts from, or
/// without any where there is no sampler.
void keep_image(const GenerateOptions& options, const Sampler* sampler, int i,
                torch::Tensor& latents) {
    if (!options.keep.defined()) return;
    ITEM3D_CHECK(options.image.defined(), "what is kept must be in a picture");
    const torch::Tensor mask = options.keep.to(latents.device(), torch::kFloat32);
    torch::Tensor image = options.image.to(latents.device(), torch::kFloat32);
    if (sampler)
        image = sampler->add_noise(i, image, noise_like(image, options.seed, first_kept + i));
    latents = image * mask + latents * (1 - mask);
}

/// Classifier-free guidance (Ho and Salimans 2022): the network, asked with and without the prompt.
class GuidedNetwork {
  public:
    GuidedNetwork(const Pipeline& pipeline, const GenerateOptions& options, std::int64_t rows,
                  const torch::Tensor& condition)
        : pipeline_(pipeline),
          scale_(options.guidance_scale),
          text_(pipeline.encode_text({options.prompt}).expand(rows)) {
        if (condition.defined())
            condition_ = condition.to(pipeline.device()).expand({rows, -1, -1, -1});
        if (!guided()) return;
        const TextEmbedding without = options.negative_prompt
                                          ? pipeline.encode_text({*options.negative_prompt})
                                          : pipeline.encode_no_text();
        text_ = TextEmbedding::join(without.expand(rows), text_);
        if (condition_.defined()) condition_ = torch::cat({condition_, condition_});
    }

    torch::Tensor operator()(const torch::Tensor& latents, double timestep) const {
        const torch::Tensor input = guided() ? torch::cat({latents, latents}) : latents;
        const torch::Tensor timesteps =
            torch::full({input.size(0)}, timestep, torch::kFloat32).to(latents.device());
        const torch::Tensor output = pipeline_.predict(input, timesteps, text_, condition_);
        if (!guided()) return output;
        const auto halves = output.chunk(2);
        return halves[0] + scale_ * (halves[1] - halves[0]);
    }

  private:
    bool guided() const { return scale_ != 1.0f; }

    const Pipeline& pipeline_;
    float scale_;
    TextEmbedding text_;
    torch::Tensor condition_;
};

}  // namespace

torch::Tensor generate_latents(const Pipeline& pipeline, const GenerateOptions& options,
                               const torch::Tensor& condition) {
    const torch::NoGradGuard no_grad;
    ITEM3D_CHECK(options.count >= 1, "count must be at least 1");
    const NoiseSchedule schedule = choose_schedule(pipeline, options);
    const int skipped = skipped_steps(options);
    if (skipped == options.steps) return options.image.to(pipeline.device(), torch::kFloat32);
    const auto sampler = make_sampler(schedule, {options.steps, skipped, options.eta});
    torch::Tensor latents = starting_latents(pipeline, options, *sampler);
    const GuidedNetwork network(pipeline, options, latents.size(0), condition);

    std::optional<Progress> progress;
    if (options.show_progress) progress.emplace("generate", sampler->steps());
    for (int i = 0; i < sampler->steps(); ++i) {
        keep_image(options, sampler.get(), i, latents);
        const torch::Tensor output =
            network(sampler->scale_input(i, latents), sampler->timestep(i));
        const torch::Tensor fresh = sampler->draws_noise(i)
                                        ? noise_like(latents, options.seed, skipped + i + 1)
                                        : torch::Tensor();
        latents = sampler->step(i, output, latents, fresh);
        if (progress) progress->update(i + 1);
        if (interrupted()) throw Interrupted("generate: stopped");
    }
    keep_image(options, nullptr, 0, latents);
    return latents;
}

torch::Tensor generate(const Pipeline& pipeline, const GenerateOptions& options,
                       const torch::Tensor& condition) {
    const torch::NoGradGuard no_grad;
    const torch::Tensor images =
        pipeline.decode_image(generate_latents(pipeline, options, condition));
    return (images / 2 + 0.5).clamp(0, 1).permute({0, 2, 3, 1}).contiguous();
}

}  // namespace item3d
