// Guidance by CLIP without a diffusion model. It has two losses: the released loss of CLIP-NeRF
// (Wang et al. 2022), and the loss of the direction between the sentences (StyleGAN-NADA, Gal et
// al. 2022).
#pragma once

#include "item3d/guidance/guidance.h"
#include "item3d/networks/vision_language/clip.h"

#include <memory>
#include <string>

namespace item3d {

enum class ClipLoss {
    absolute,    ///< 1 - cos(f(I), f(target)), f: CLIP's features, I: the image
    directional  ///< 1 - cos(f(I) - f(I_0), f(target) - f(source)), I_0: the unedited model's image
};

/// Returns the losses [N] of images by their CLIP features; differentiable. All features have unit
/// length. image: [N, D]; target, source: [1, D], of the sentences; before: [N, D], of the unedited
/// model's images, used only by ClipLoss::directional.
at::Tensor clip_losses(ClipLoss loss, const at::Tensor& image, const at::Tensor& before,
                       const at::Tensor& target, const at::Tensor& source);

/// Guidance by a ClipLoss. In its GuidanceOutput, `latents` are the images themselves and
/// `direction_length` is the mean loss.
class ClipGuidance : public Guidance {
  public:
    ClipGuidance(std::shared_ptr<const Clip> clip, const std::string& source_prompt,
                 const std::string& target_prompt, ClipLoss loss);
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
    bool needs_reference() const override { return loss_ == ClipLoss::directional; }

  private:
    std::shared_ptr<const Clip> clip_;
    ClipLoss loss_;
    at::Tensor target_, source_;  ///< [1, D]
};

}  // namespace item3d
