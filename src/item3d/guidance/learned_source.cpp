#include "item3d/guidance/learned_source.h"

#include "item3d/core/error.h"
#include "item3d/guidance/prediction.h"
#include "item3d/processes/gradients.h"

#include <cmath>

namespace item3d {
namespace {

constexpr double beta1 = 0.9;
constexpr double beta2 = 0.999;
constexpr double epsilon = 1e-8;

at::Tensor find(const NamedTensors& state, const std::string& name) {
    for (const auto& [key, tensor] : state) {
        if (key == name) return tensor;
    }
    throw InputError("checkpoint", "has no tensor " + name, "start without --resume");
}

}  // namespace

LearnedSource::LearnedSource(const TextEmbedding& source, const GuidanceOptions& options)
    : options_(options) {
    const auto add = [&](const std::string& name, const at::Tensor& start) {
        const at::Tensor embedding = start.detach().clone().to(at::kFloat);
        parts_.push_back({name, embedding, at::zeros_like(embedding), at::zeros_like(embedding)});
    };
    add("source.", source.states);
    if (source.pooled.defined()) add("source.pooled_", source.pooled);
}

NoisedLatents LearnedSource::rows(const DiffusionModel& pipeline, const NoisedLatents& latents,
                                  std::int64_t iteration) const {
    const int more = options_.adjust_samples - 1;
    return more > 0
               ? join_rows(latents, renoise_latents(pipeline, latents, options_, iteration, more))
               : latents;
}

at::Tensor LearnedSource::predict_and_follow(const DiffusionModel& pipeline,
                                             const NoisedLatents& rows, const Share& share) {
    std::vector<at::Tensor> embeddings;
    for (const Part& part : parts_)
        embeddings.push_back(part.embedding.detach().requires_grad_(true));
    at::Tensor prediction = at::empty({0}, rows.noisy.options());
    at::Tensor loss = at::zeros({1}, rows.noisy.options());
    if (share.count > 0) {
        const NoisedLatents own = narrow_rows(rows, share);
        const TextEmbedding text{embeddings[0], parts_.size() > 1 ? embeddings[1] : at::Tensor()};
        prediction = pipeline.predict_noise(own.noisy, own.timesteps, text, own.condition);
        loss = denoising_loss(pipeline, prediction, own) *
               (static_cast<double>(share.count) / static_cast<double>(rows.noisy.size(0)));
        loss.backward({}, std::nullopt, /*create_graph=*/false, embeddings);
    }
    sum_gradients(rows.processes, embeddings);
    loss = loss.detach().reshape({1}).clone();
    rows.processes.sum(loss);
    loss_ = loss.item<float>();

    const at::NoGradGuard no_grad;
    // A gradient that is not finite would stay in the embedding.
    for (const at::Tensor& embedding : embeddings)
        if (!embedding.grad().isfinite().all().item<bool>()) return prediction.detach();
    ++steps_;
    const double correction1 = 1 - std::pow(beta1, static_cast<double>(steps_));
    const double correction2 = 1 - std::pow(beta2, static_cast<double>(steps_));
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        Part& part = parts_[i];
        const at::Tensor gradient = embeddings[i].grad();
        part.first_moment.mul_(beta1).add_(gradient, 1 - beta1);
        part.second_moment.mul_(beta2).addcmul_(gradient, gradient, 1 - beta2);
        part.embedding = part.embedding - options_.adjust_learning_rate / correction1 *
                                              part.first_moment /
                                              ((part.second_moment / correction2).sqrt() + epsilon);
    }
    return prediction.detach();
}

TextEmbedding LearnedSource::embedding() const {
    return {parts_[0].embedding, parts_.size() > 1 ? parts_[1].embedding : at::Tensor()};
}

NamedTensors LearnedSource::state() const {
    NamedTensors state;
    for (const Part& part : parts_) {
        state.emplace_back(part.name + "embedding", part.embedding);
        state.emplace_back(part.name + "first_moment", part.first_moment);
        state.emplace_back(part.name + "second_moment", part.second_moment);
    }
    state.emplace_back("source.steps", at::tensor({steps_}, at::kLong));
    return state;
}

void LearnedSource::load_state(const NamedTensors& state) {
    for (Part& part : parts_) {
        const at::Tensor embedding = find(state, part.name + "embedding");
        if (embedding.sizes() != part.embedding.sizes())
            throw InputError("checkpoint",
                             "its source embedding does not have the shape of this prior's",
                             "resume with the prior that the edit was started with");
        const at::Device device = part.embedding.device();
        part.embedding = embedding.to(device);
        part.first_moment = find(state, part.name + "first_moment").to(device).clone();
        part.second_moment = find(state, part.name + "second_moment").to(device).clone();
    }
    steps_ = find(state, "source.steps").item<std::int64_t>();
}

}  // namespace item3d
