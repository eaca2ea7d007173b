#include "item3d/guidance/rdl.h"

#include "item3d/guidance/prediction.h"

#include <algorithm>

namespace item3d {

RelativeDirection::RelativeDirection(std::shared_ptr<const DiffusionModel> pipeline,
                                     const std::string& source_prompt,
                                     const std::string& target_prompt,
                                     const GuidanceOptions& options)
    : pipeline_(std::move(pipeline)), options_(options) {
    const TextEmbedding text = pipeline_->encode_text({target_prompt, source_prompt});
    target_text_ = text.row(0);
    source_text_ = text.row(1);
    if (options_.adjust == Adjustment::learned) {
        learned_source_.emplace(source_text_, options_);
    }
}

PromptPair predict_pair(const DiffusionModel& pipeline, const NoisedLatents& start,
                        const TextEmbedding& target_text, const TextEmbedding& source_text) {
    const auto both = predict_each(pipeline, noisy_input(start), {target_text, source_text});
    return {both[0], both[1]};
}

TextEmbedding RelativeDirection::source() const {
    if (learned_source_) return learned_source_->embedding();
    return source_shift_.states.defined() ? add_scaled(source_text_, source_shift_, 1)
                                          : source_text_;
}

void RelativeDirection::shift_source(const TextEmbedding& shift) {
    source_shift_ = shift;
}

std::optional<TextDirection> RelativeDirection::text_direction() const {
    return compare_directions(target_text_, source_text_, source());
}

PromptPair RelativeDirection::predict(const NoisedLatents& start, std::int64_t iteration) {
    if (!learned_source_) return predict_pair(*pipeline_, start, target_text_, source());
    const NoisedLatents rows = learned_source_->rows(*pipeline_, start, iteration);
    const std::int64_t views = start.noisy.size(0), sources = rows.noisy.size(0);
    // The rows of the source also need a gradient, so the rows of the source and those of the
    // target are shared out separately. If they cannot be shared out evenly, the last processes
    // take the remaining rows of the source, and the first processes take the remaining rows of the
    // target.
    const ProcessGroup& processes = start.processes;
    const Share of_source = processes.share(sources);
    const Share of_target =
        share_of(processes.size() - 1 - processes.rank(), processes.size(), views);
    const at::Tensor source = learned_source_->predict_and_follow(*pipeline_, rows, of_source);

    const at::NoGradGuard no_grad;
    at::Tensor target;
    if (of_target.count > 0) {
        const NoisedLatents mine = narrow_rows(start, of_target);
        target = pipeline_->predict_noise(mine.noisy, mine.timesteps, target_text_, mine.condition);
    }
    if (!processes.several()) return {target, source.narrow(0, 0, views)};
    at::Tensor both = at::zeros_like(at::cat({start.noisy, start.noisy}));
    const std::int64_t shown =
        std::clamp<std::int64_t>(views - of_source.first, 0, of_source.count);
    if (shown > 0) both.narrow(0, of_source.first, shown).copy_(source.narrow(0, 0, shown));
    if (of_target.count > 0) both.narrow(0, views + of_target.first, of_target.count).copy_(target);
    processes.sum(both);
    return {both.narrow(0, views, views), both.narrow(0, 0, views)};
}

GuidanceOutput RelativeDirection::step(const GuidanceInput& input, std::int64_t iteration) {
    const NoisedLatents start = noise_latents(*pipeline_, input, options_, iteration);
    const double before = seconds_now();
    const PromptPair predictions = predict(start, iteration);

    const at::NoGradGuard no_grad;
    const at::Tensor direction = predictions.target - predictions.source;
    at::Tensor gradient = options_.guidance_scale * direction;
    if (options_.anchor != 0)
        gradient = gradient + options_.anchor * (predictions.target - start.noise);

    GuidanceOutput output = finish_step(start, direction, start.weight * gradient, before);
    output.source_loss = learned_source_
                             ? learned_source_->loss()
                             : denoising_loss(*pipeline_, predictions.source, start).item<float>();
    return output;
}

NamedTensors RelativeDirection::state() const {
    if (learned_source_) return learned_source_->state();
    NamedTensors state;
    if (source_shift_.states.defined()) state.emplace_back("shift.states", source_shift_.states);
    if (source_shift_.pooled.defined()) state.emplace_back("shift.pooled", source_shift_.pooled);
    return state;
}

void RelativeDirection::load_state(const NamedTensors& state) {
    if (learned_source_) {
        learned_source_->load_state(state);
        return;
    }
    for (const auto& [name, tensor] : state) {
        const at::Tensor value = tensor.to(source_text_.states.device()).clone();
        (name == "shift.pooled" ? source_shift_.pooled : source_shift_.states) = value;
    }
}

}  // namespace item3d
