// A source embedding that follows the render (--adjust learned).
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
    /// source: one row, copied. Its pooled part, if any, is optimised too.
    LearnedSource(const TextEmbedding& source, const GuidanceOptions& options);

    /// Returns the batch for one step of the embedding: these latents, then each of them under
    /// options.adjust_samples - 1 other noises.
    NoisedLatents rows(const DiffusionModel& pipeline, const NoisedLatents& latents,
                       std::int64_t iteration) const;
    /// Returns the constant eps(source) of this process's share of rows(), which may be empty; then
    /// takes one step of the embedding with the rows of all processes.
    at::Tensor predict_and_follow(const DiffusionModel& pipeline, const NoisedLatents& rows,
                                  const Share& share);
    /// Returns the denoising loss of the last call, for the U-Net's own target (eps or v).
    float loss() const { return loss_; }
    /// Returns the current source, one row.
    TextEmbedding embedding() const;

    NamedTensors state() const;
    void load_state(const NamedTensors& state);

  private:
    /// A tensor of the embedding with its state of Adam.
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
