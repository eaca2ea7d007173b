// Noise-free score distillation (Katzir et al. 2023):
//   g = omega(t) [ d + w (eps(y_target) - eps(empty)) ],
//   d = eps(empty) for t < 200 of 1000, else eps(empty) - eps(negative).
// sds's noise residual eps(empty) - eps is replaced by a part of it that points to real pictures,
// so that an ordinary w will do. The source prompt is not used.
#pragma once

#include "item3d/guidance/guidance.h"

namespace item3d {

class NoiseFreeDistillation : public Guidance {
  public:
    NoiseFreeDistillation(std::shared_ptr<const Pipeline> pipeline,
                          const std::string& target_prompt, const GuidanceOptions& options);
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;

  private:
    std::shared_ptr<const Pipeline> pipeline_;
    GuidanceOptions options_;
    TextEmbedding target_text_;  ///< one row each
    TextEmbedding no_text_;
    TextEmbedding negative_text_;
};

}  // namespace item3d
