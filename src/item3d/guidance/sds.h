// Score distillation sampling (Poole et al. 2022, DreamFusion; symbols: guidance.h), the baseline:
//   g = omega(t) (eps^w(y_target) - eps),  eps^w(y) = eps(n) + w (eps(y) - eps(n))
//
// where n is the negative prompt, which is empty by default. The source prompt is not used.
#pragma once

#include "item3d/guidance/target_guidance.h"

namespace item3d {

class ScoreDistillation : public TargetGuidance {
  public:
    using TargetGuidance::TargetGuidance;
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
};

}  // namespace item3d
