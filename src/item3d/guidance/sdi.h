// Score distillation via inversion (Lukoianov et al. 2024; symbols: guidance.h):
//   g = z - clean(z_t, eps^w(z_t, y_target)),
//
// where clean() is clean_latents() of prediction.h. z_t comes from z by DDIM's inversion with the
// target's prompt and the guidance scale 2 - w. (The published w is 8.5, the published scale of the
// inversion is -6.5.) The inversion has strides of 100 of 1000 timesteps. Each step adds fresh
// noise, with 0.3 of the deviation of DDIM at eta 1. The noise thus fits the image and the prompt,
// and g varies little from step to step. Textures are sharp, but a step takes up to 24 rows of the
// U-Net for each image. The method is meant for --timestep-schedule anneal. The source prompt is
// not used; a negative prompt replaces the empty one.
#pragma once

#include "item3d/guidance/noised_latents.h"
#include "item3d/guidance/target_guidance.h"

namespace item3d {

class InversionDistillation : public TargetGuidance {
  public:
    using TargetGuidance::TargetGuidance;
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;

    /// Returns the rising timesteps of the inversion to t. Those below t are one stride apart; the
    /// first may be negative, which means no noise. The last is t or up to a stride above it. draw:
    /// position of the last timestep above t, in [0, 1) strides.
    std::vector<std::int64_t> inversion_levels(std::int64_t t, double draw) const;

  private:
    at::Tensor invert(const NoisedLatents& start, std::int64_t t, std::int64_t iteration) const;
};

}  // namespace item3d
