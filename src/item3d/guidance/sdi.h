// Score distillation via inversion (Lukoianov et al. 2024):
//   g = z - clean(z_t, eps^w(z_t, y_target)),
//
// where z_t comes from z by DDIM's inversion with the target's prompt and the guidance scale 2 - w
// (w is published as 8.5 and the inversion's as -6.5), in strides of 100 of 1000, with 0.3 of
// DDIM's variance as fresh noise. The noise thus fits the image and the prompt, and g varies little
// from step to step: sharp textures, for up to 24 U-Net rows. Meant for --timestep-schedule anneal.
// The source prompt is not used; a negative prompt replaces the empty one.
#pragma once

#include "item3d/guidance/noised_latents.h"
#include "item3d/guidance/target_guidance.h"

namespace item3d {

class InversionDistillation : public TargetGuidance {
  public:
    using TargetGuidance::TargetGuidance;
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;

    /// Returns the timesteps of the inversion to t, rising: levels one stride apart below t, of
    /// which the first may be negative (no noise), and a last one up to a stride above t. draw: in
    /// [0, 1), position of the last.
    std::vector<std::int64_t> inversion_levels(std::int64_t t, double draw) const;

  private:
    at::Tensor invert(const NoisedLatents& start, std::int64_t t, std::int64_t iteration) const;
};

}  // namespace item3d
