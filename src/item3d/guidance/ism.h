// Interval score matching (Liang et al. 2024, LucidDreamer; symbols: guidance.h):
//   g = sqrt((1 - abar_t) / abar_t) (eps^w(z_t, y_target) - eps(z_s, empty)),
//
// where z_s and z_t lie on one path. The path is DDIM's inversion without a prompt, in strides of
// 200 of 1000 timesteps up to s, and then one step to t = s + delta. The noise comes from the image
// itself and is not random, so the targets of different iterations agree and do not average to
// blur. In the first 0.3 of the edit, the upper end of the timesteps falls from max_timestep to the
// middle of the range, and delta falls from 100 to 80 of 1000 timesteps. The source prompt is not
// used; a negative prompt replaces the empty one.
#pragma once

#include "item3d/guidance/target_guidance.h"

namespace item3d {

class IntervalScore : public TargetGuidance {
  public:
    using TargetGuidance::TargetGuidance;
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
};

}  // namespace item3d
