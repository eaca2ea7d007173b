// Delta denoising score (Hertz et al. 2023; symbols: guidance.h):
//   g = eps^w(z_t, y_target) - eps^w(zref_t, y_source),
//
// where zref are the latents of the unedited model, from the same cameras and under the same noise.
// If the prompts are equal and nothing was edited, both terms are equal. Features that no word
// mentions cancel. There is no omega(t), because its exponents are published as 0.
#pragma once

#include "item3d/guidance/guidance.h"

namespace item3d {

class DeltaDenoising : public Guidance {
  public:
    DeltaDenoising(std::shared_ptr<const DiffusionModel> pipeline, const std::string& source_prompt,
                   const std::string& target_prompt, const GuidanceOptions& options);
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
    bool needs_reference() const override { return true; }

  private:
    std::shared_ptr<const DiffusionModel> pipeline_;
    GuidanceOptions options_;
    TextEmbedding target_text_;  ///< these embeddings have one row each
    TextEmbedding source_text_;
    TextEmbedding base_text_;  ///< the negative prompt, or none
};

}  // namespace item3d
