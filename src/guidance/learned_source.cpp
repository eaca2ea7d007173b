#include "item3d/guidance/learned_source.h"

#include "item3d/core/error.h"

#include <torch/csrc/autograd/autograd.h>

#include <cmath>

namespace item3d {
namespace {

constexpr double beta1 = 0.9;
constexpr double beta2 = 0.999;
constexpr double epsilon = 1e-8;

torch::Tensor find(const NamedTensors& state, const std::string& name) {
    for (const auto& [key, tensor] : state) {
        if (key == name) return tensor;
    }
    throw InputError("checkpoint", "has no tensor " + name, "start without --resume");
}

}  // namespace

LearnedSource::LearnedSource(const torch::Tensor& source, const GuidanceOptions& options)
    : options_(options),
      embedding_(source.detach().clone().to(torch::kFloat32)),
      first_moment_(torch::zeros_like(embedding_)),
      second_moment_(torch::zeros_like(embedding_)) {}

torch::Tensor LearnedSource::predict_and_follow(const Pipeline& pipeline, const NoisedLatents& own,
                                                std::int64_t iteration) {
    const int more = options_.adjust_samples - 1;
    const NoisedLatents latents =
        more > 0 ? join_rows(own, renoise_latents(pipeline, own, options_, iteration, more)) : own;
    torch::Tensor embedding = embedding_.detach().requires_grad_(true);
    const torch::Tensor prediction =
        pipeline.predict_noise(latents.noisy, latents.timesteps,
                               repeat_text(embedding, latents.noisy.size(0)), latents.condition);
    torch::Tensor error = prediction - latents.noise;
    // An error of v is an error of eps divided by sqrt(abar); the loss is the one the model was
    // trained with.
    if (pipeline.scheduler.predicts_velocity()) error = error / latents.alphas_cumprod.sqrt();
    const torch::Tensor loss = error.square().mean();
    const torch::Tensor gradient = torch::autograd::grad({loss}, {embedding})[0];
    loss_ = loss.item<float>();

    const torch::NoGradGuard no_grad;
    ++steps_;
    first_moment_.mul_(beta1).add_(gradient, 1 - beta1);
    second_moment_.mul_(beta2).addcmul_(gradient, gradient, 1 - beta2);
    const double correction1 = 1 - std::pow(beta1, static_cast<double>(steps_));
    const double correction2 = 1 - std::pow(beta2, static_cast<double>(steps_));
    embedding_ = embedding_ - options_.adjust_learning_rate / correction1 * first_moment_ /
                                  ((second_moment_ / correction2).sqrt() + epsilon);
    return prediction.detach().narrow(0, 0, own.noisy.size(0));
}

NamedTensors LearnedSource::state() const {
    return {{"source.embedding", embedding_},
            {"source.first_moment", first_moment_},
            {"source.second_moment", second_moment_},
            {"source.steps", torch::tensor({steps_}, torch::kInt64)}};
}

void LearnedSource::load_state(const NamedTensors& state) {
    const torch::Tensor embedding = find(state, "source.embedding");
    if (embedding.sizes() != embedding_.sizes()) {
        throw InputError("checkpoint", "its source embedding has another shape than this prior's",
                         "resume with the prior that began the edit");
    }
    embedding_ = embedding.to(embedding_.device());
    first_moment_ = find(state, "source.first_moment").to(embedding_.device()).clone();
    second_moment_ = find(state, "source.second_moment").to(embedding_.device()).clone();
    steps_ = find(state, "source.steps").item<std::int64_t>();
}

}  // namespace item3d
