// Noise-free score distillation (Katzir et al. 2023):
//   g = omega(t) [ d + w (eps(y_target) - eps(empty)) ],
//   d = eps(empty) for t < 200 of 1000, else eps(empty) - eps(negative).
//
// sds's noise residual eps(empty) - eps is replaced by its component towards real images, so that
// an ordinary w suffices. The source prompt is not used.
#pragma once

#include "item3d/guidance/target_guidance.h"

namespace item3d {

class NoiseFreeDistillation : public NegativeGuidance {
  public:
    using NegativeGuidance::NegativeGuidance;
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
};

}  // namespace item3d
