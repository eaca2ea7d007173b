// A source embedding that follows the render (--adjust learned; symbols: guidance.h).
//
// The relative direction eps(y_target) - eps(y_source) does not vanish at the target, because the
// source prompt keeps describing the initial render. Here the source starts at the source prompt's
// embedding and takes one Adam step in each iteration that lowers the denoising loss of the current
// render, so that it always describes the current state. It is the paper's direction adjustment
// (section 3.4) without a captioner.
#pragma once

#include "item3d/guidance/guidance.h"
#include "item3d/guidance/noised_latents.h"

#include <string>
#include <vector>

namespace item3d {

class LearnedSource {
  public:
    /// source: the source prompt's embedding, one row, which is copied. Its pooled part is
    /// optimised too if it has one.
    LearnedSource(const TextEmbedding& source, const GuidanceOptions& options);

    /// Returns the batch of one optimiser step of the embedding. It has the given noised latents.
    /// Then it has each clean latent options.adjust_samples - 1 more times, with other noises.
    NoisedLatents rows(const DiffusionModel& pipeline, const NoisedLatents& latents,
                       std::int64_t iteration) const;
    /// Returns the predictions eps(source), as constants, for this process's share of rows(); the
    /// share may be empty. Also takes one step of the embedding with the rows of all processes,
    /// unless its gradient is not finite.
    at::Tensor predict_and_follow(const DiffusionModel& pipeline, const NoisedLatents& rows,
                                  const Share& share);
    /// Returns the denoising loss of the last step, for what the U-Net predicts (eps or the
    /// velocity).
    float loss() const { return loss_; }
    /// Returns the current source embedding, one row.
    TextEmbedding embedding() const;

    NamedTensors state() const;
    void load_state(const NamedTensors& state);

  private:
    /// A tensor of the embedding, with its moments for Adam.
    struct Part {
        std::string name;  ///< prefix of tensor names in a checkpoint
        at::Tensor embedding;
        at::Tensor first_moment;
        at::Tensor second_moment;
    };

    GuidanceOptions options_;
    std::vector<Part> parts_;  ///< hidden states, and for SDXL the pooled embedding
    std::int64_t steps_ = 0;
    float loss_ = 0;
};

}  // namespace item3d
