// Noise-free score distillation (Katzir et al. 2023; symbols: guidance.h):
//   g = omega(t) [ d + w (eps(y_target) - eps(empty)) ],
//   d = eps(empty) for t < 200 of 1000, else eps(empty) - eps(negative).
//
// The residual noise of sds, eps(empty) - eps, is replaced by d, its component towards real images.
// An ordinary w then suffices. The source prompt is not used.
#pragma once

#include "item3d/guidance/target_guidance.h"

namespace item3d {

class NoiseFreeDistillation : public NegativeGuidance {
  public:
    using NegativeGuidance::NegativeGuidance;
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
};

}  // namespace item3d
