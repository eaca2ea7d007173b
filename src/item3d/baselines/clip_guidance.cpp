#include "item3d/baselines/clip_guidance.h"

#include "item3d/guidance/noised_latents.h"

namespace item3d {
namespace {

at::Tensor cosine_of(const at::Tensor& a, const at::Tensor& b) {
    // The difference of an unedited image has length 0, at which its gradient must stay finite.
    const auto length = [](const at::Tensor& x) { return (x.square().sum(1) + 1e-8).sqrt(); };
    return (a * b).sum(1) / (length(a) * length(b));
}

}  // namespace

at::Tensor clip_losses(ClipLoss loss, const at::Tensor& image, const at::Tensor& before,
                       const at::Tensor& target, const at::Tensor& source) {
    if (loss == ClipLoss::absolute) return 1 - (image * target).sum(1);
    return 1 - cosine_of(image - before, target - source);
}

ClipGuidance::ClipGuidance(std::shared_ptr<const Clip> clip, const std::string& source_prompt,
                           const std::string& target_prompt, ClipLoss loss)
    : clip_(std::move(clip)), loss_(loss) {
    const at::Tensor texts = clip_->embed_texts({target_prompt, source_prompt});
    target_ = texts.narrow(0, 0, 1);
    source_ = texts.narrow(0, 1, 1);
}

GuidanceOutput ClipGuidance::step(const GuidanceInput& input, std::int64_t) {
    const double began = seconds_now();
    const at::Tensor images = input.images.detach().clone().requires_grad_();
    at::Tensor total = at::zeros({1});
    if (images.size(0) > 0) {
        at::Tensor before;
        if (needs_reference()) {
            const at::NoGradGuard no_grad;
            before = clip_->embed_images(input.reference);
        }
        const at::Tensor loss =
            clip_losses(loss_, clip_->embed_images(images), before, target_, source_).sum();
        loss.backward();
        total[0] = loss.item<float>();
    }
    input.processes.sum(total);
    GuidanceOutput output;
    output.latents = input.images;
    output.latents_gradient = images.grad();
    output.direction_length = total.item<float>() / static_cast<float>(input.views());
    output.seconds_encode = seconds_now() - began;
    return output;
}

}  // namespace item3d
