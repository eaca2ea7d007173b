// Classifier score distillation (Yu et al. 2023) with the coefficients of DreamMat (Zhang et al.
// 2024), whose light-aware ControlNet is not part of this:
//   g = omega(t) [ c eps(y_target) + u eps(negative) + n eps(empty) ],
// c = 1.05; u rises from -1 to -0.5 and n falls from 0 to -0.5 over the edit. The coefficients
// nearly cancel and no noise is left in it, so no large w is needed, and --cfg is not used. The
// timesteps are clamped into 0.2 .. 0.8 in the first quarter of the edit and 0.02 .. 0.5 after it.
#pragma once

#include "item3d/guidance/target_guidance.h"

namespace item3d {

class ClassifierScore : public NegativeGuidance {
  public:
    using NegativeGuidance::NegativeGuidance;
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
};

}  // namespace item3d
