// Relative direction (ITEM3D, section 3.3), in its two-row form:
//   g = omega(t) [ w (eps(y_target) - eps(y_source)) + lambda (eps(y_target) - eps) ].
// With eps^w(y) = eps(empty) + w (eps(y) - eps(empty)) in both branches, the unconditional term of
// eps^w(y_target) - eps^w(y_source) cancels, so two U-Net rows an image are enough; a negative
// prompt in place of the empty one cancels as well. lambda is the anchor (--anchor): a pull to the
// target's own score that plain RDL (lambda 0) lacks.
#pragma once

#include "item3d/guidance/guidance.h"
#include "item3d/guidance/learned_source.h"

#include <optional>

namespace item3d {

/// eps(y_target) and eps(y_source) of the same noised latents, constants.
struct PromptPair {
    at::Tensor target;  ///< [N, C, h, w]
    at::Tensor source;  ///< [N, C, h, w]
};

/// Both in one batch of two rows an image; texts are one row.
PromptPair predict_pair(const DiffusionModel& pipeline, const NoisedLatents& start,
                        const TextEmbedding& target_text, const TextEmbedding& source_text);

class RelativeDirection : public Guidance {
  public:
    RelativeDirection(std::shared_ptr<const DiffusionModel> pipeline,
                      const std::string& source_prompt, const std::string& target_prompt,
                      const GuidanceOptions& options);
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
    /// Without a learned source.
    void shift_source(const TextEmbedding& shift) override;
    std::optional<TextDirection> text_direction() const override;
    NamedTensors state() const override;
    void load_state(const NamedTensors& state) override;

  private:
    /// One row: the prompt's embedding, or what stands for it by now.
    TextEmbedding source() const;
    PromptPair predict(const NoisedLatents& start, std::int64_t iteration);

    std::shared_ptr<const DiffusionModel> pipeline_;
    GuidanceOptions options_;
    TextEmbedding target_text_;  ///< one row, as the source's
    TextEmbedding source_text_;
    TextEmbedding source_shift_;  ///< undefined until there is one
    std::optional<LearnedSource> learned_source_;
};

}  // namespace item3d
