// Posterior distillation sampling (Koo et al. 2024; symbols: guidance.h). The gradient is the
// difference of two stochastic latents s, one for the target and one for the source. A stochastic
// latent is the noise that takes latents from t to the previous step t' of a grid of 500 DDIM
// steps:
//   g = s(z, y_target) - s(zref, y_source),   s(z, y) = (z_t' - mu(z_t, eps^w(z_t, y))) / sigma.
//
// Both have the same noise at t and the same noise at t'. zref are the latents of the unedited
// model; mu and sigma are the mean and the deviation of DDPM's posterior. In addition to the
// difference of predictions as in dds, g contains a pull of z to zref, with a weight that depends
// on t. This pull preserves the model's identity.
#pragma once

#include "item3d/guidance/noised_latents.h"

namespace item3d {

class PosteriorDistillation : public Guidance {
  public:
    PosteriorDistillation(std::shared_ptr<const DiffusionModel> pipeline,
                          const std::string& source_prompt, const std::string& target_prompt,
                          const GuidanceOptions& options);
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
    bool needs_reference() const override { return true; }

  private:
    /// A step of the grid, for s(z, y) above.
    struct Step;
    at::Tensor stochastic_latents(const NoisedLatents& start, const Step& step,
                                  const at::Tensor& latents, const TextEmbedding& text) const;

    std::shared_ptr<const DiffusionModel> pipeline_;
    GuidanceOptions options_;
    TextEmbedding target_text_;  ///< these embeddings have one row each
    TextEmbedding source_text_;
    TextEmbedding base_text_;  ///< the negative prompt, or none
};

}  // namespace item3d
