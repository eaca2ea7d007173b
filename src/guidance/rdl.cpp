#include "item3d/guidance/rdl.h"

#include "item3d/guidance/prediction.h"

namespace item3d {

RelativeDirection::RelativeDirection(std::shared_ptr<const Pipeline> pipeline,
                                     const std::string& source_prompt,
                                     const std::string& target_prompt,
                                     const GuidanceOptions& options)
    : pipeline_(std::move(pipeline)), options_(options) {
    const TextEmbedding text = pipeline_->encode_text({target_prompt, source_prompt});
    target_text_ = text.row(0);
    source_text_ = text.row(1);
    if (options_.adjust == "learned") {
        learned_source_.emplace(source_text_, options_);
    }
}

PromptPair predict_pair(const Pipeline& pipeline, const NoisedLatents& start,
                        const TextEmbedding& target_text, const TextEmbedding& source_text) {
    const auto both = predict_each(pipeline, noisy_input(start), {target_text, source_text});
    return {both[0], both[1]};
}

PromptPair RelativeDirection::predict(const NoisedLatents& start, std::int64_t iteration) {
    if (!learned_source_) return predict_pair(*pipeline_, start, target_text_, source_text_);
    const torch::Tensor source = learned_source_->predict_and_follow(*pipeline_, start, iteration);
    const torch::NoGradGuard no_grad;
    const torch::Tensor target =
        pipeline_->predict_noise(start.noisy, start.timesteps, target_text_, start.condition);
    return {target, source};
}

GuidanceOutput RelativeDirection::step(const GuidanceInput& input, std::int64_t iteration) {
    const NoisedLatents start = noise_latents(*pipeline_, input, options_, iteration);
    const double before = seconds_now();
    const PromptPair predictions = predict(start, iteration);

    const torch::NoGradGuard no_grad;
    const torch::Tensor direction = predictions.target - predictions.source;
    torch::Tensor gradient = options_.guidance_scale * direction;
    if (options_.anchor != 0)
        gradient = gradient + options_.anchor * (predictions.target - start.noise);

    GuidanceOutput output = finish_step(start, direction, start.weight * gradient, before);
    output.adjustment_loss = learned_source_ ? learned_source_->loss() : 0.0f;
    return output;
}

NamedTensors RelativeDirection::state() const {
    return learned_source_ ? learned_source_->state() : NamedTensors{};
}

void RelativeDirection::load_state(const NamedTensors& state) {
    if (learned_source_) learned_source_->load_state(state);
}

}  // namespace item3d
