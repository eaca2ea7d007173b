// Score distillation sampling (Poole et al. 2022, DreamFusion), the baseline:
//   g = omega(t) (eps^w(y_target) - eps),  eps^w(y) = eps(n) + w (eps(y) - eps(n))
// with the negative prompt n, empty by default. The source prompt is not used.
#pragma once

#include "item3d/guidance/guidance.h"

namespace item3d {

class ScoreDistillation : public Guidance {
  public:
    ScoreDistillation(std::shared_ptr<const Pipeline> pipeline, const std::string& target_prompt,
                      const GuidanceOptions& options);
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;

  private:
    std::shared_ptr<const Pipeline> pipeline_;
    GuidanceOptions options_;
    TextEmbedding target_text_;  ///< one row each
    TextEmbedding base_text_;    ///< none, or the negative prompt
};

}  // namespace item3d
