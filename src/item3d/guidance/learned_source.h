// A source embedding that follows the render (--adjust learned).
//
// The relative direction eps(y_target) - eps(y_source) does not vanish once the target is reached,
// because the source prompt keeps describing the picture that was there before. Here the source
// starts at the source prompt's embedding and takes one Adam step an iteration that lowers the
// denoising loss of the current render, so that it always describes what is there now. It is the
// paper's direction adjustment (section 3.4) without a captioner.
#pragma once

#include "item3d/guidance/guidance.h"
#include "item3d/guidance/noised_latents.h"

#include <string>
#include <vector>

namespace item3d {

class LearnedSource {
  public:
    /// source: one row, copied. Its pooled part, where there is one, follows too.
    LearnedSource(const TextEmbedding& source, const GuidanceOptions& options);

    /// What a step of the embedding looks at: these latents first, then options.adjust_samples - 1
    /// further noises for each of them.
    NoisedLatents rows(const DiffusionModel& pipeline, const NoisedLatents& latents,
                       std::int64_t iteration) const;
    /// eps(source) of this process's share of rows(), which may be none, a constant; then one step
    /// of the embedding, of all processes' rows.
    at::Tensor predict_and_follow(const DiffusionModel& pipeline, const NoisedLatents& rows,
                                  const Share& share);
    /// Denoising loss of the last call, in the U-Net's own target (eps or v).
    float loss() const { return loss_; }
    /// One row: what stands for the source now.
    TextEmbedding embedding() const;

    NamedTensors state() const;
    void load_state(const NamedTensors& state);

  private:
    /// A tensor of the embedding and what Adam remembers about it.
    struct Part {
        std::string name;  ///< in a checkpoint, before that of the tensor
        at::Tensor embedding;
        at::Tensor first_moment;
        at::Tensor second_moment;
    };

    GuidanceOptions options_;
    std::vector<Part> parts_;  ///< hidden states, and for SDXL what is pooled of them
    std::int64_t steps_ = 0;
    float loss_ = 0;
};

}  // namespace item3d
