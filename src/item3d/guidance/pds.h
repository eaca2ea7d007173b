// Posterior distillation sampling (Koo et al. 2024): the difference of two stochastic latents, for
// the target and for the source, each of which takes its latents from t to the previous step t' of
// a 500-step DDIM grid,
//   g = s(z, y_target) - s(zref, y_source),   s(z, y) = (z_t' - mu(z_t, eps^w(z_t, y))) / sigma,
//
// with one noise at t and one at t' for both; zref are the latents of the unedited model, mu and
// sigma the mean and deviation of DDPM's posterior. In addition to dds's difference of predictions,
// g contains a pull of z to zref with a weight that depends on t, which preserves identity.
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
    /// A grid step for s(z, y), see above.
    struct Step;
    at::Tensor stochastic_latents(const NoisedLatents& start, const Step& step,
                                  const at::Tensor& latents, const TextEmbedding& text) const;

    std::shared_ptr<const DiffusionModel> pipeline_;
    GuidanceOptions options_;
    TextEmbedding target_text_;  ///< one row each
    TextEmbedding source_text_;
    TextEmbedding base_text_;  ///< the negative prompt, or none
};

}  // namespace item3d
