// Classifier score distillation (Yu et al. 2023) with the coefficients of DreamMat (Zhang et al.
// 2024), but without DreamMat's light-aware ControlNet (symbols: guidance.h):
//   g = omega(t) [ c eps(y_target) + u eps(negative) + n eps(empty) ],
//
// where c = 1.05, u rises from -1 to -0.5 over the edit, and n falls from 0 to -0.5. The
// coefficients nearly cancel and g has no noise term, so no large guidance scale is needed, and
// --cfg is not used. The range of the timesteps is clamped to 0.2 .. 0.8 of the training timesteps
// in the first quarter of the edit, and to 0.02 .. 0.5 afterwards.
#pragma once

#include "item3d/guidance/target_guidance.h"

namespace item3d {

class ClassifierScore : public NegativeGuidance {
  public:
    using NegativeGuidance::NegativeGuidance;
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
};

}  // namespace item3d
