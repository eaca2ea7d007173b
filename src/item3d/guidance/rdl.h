// Relative direction (ITEM3D, section 3.3), in its two-row form:
//   g = omega(t) [ w (eps(y_target) - eps(y_source)) + lambda (eps(y_target) - eps) ].
//
// With eps^w(y) = eps(empty) + w (eps(y) - eps(empty)) in both branches, the unconditional term of
// eps^w(y_target) - eps^w(y_source) cancels, so two U-Net rows for each image suffice; a negative
// prompt in place of the empty one cancels as well. lambda is the anchor (--anchor): a pull to the
// target's own score that plain RDL (lambda 0) lacks.
#pragma once

#include "item3d/guidance/guidance.h"
#include "item3d/guidance/learned_source.h"

#include <optional>

namespace item3d {

/// Constants eps(y_target) and eps(y_source) for the same noised latents.
struct PromptPair {
    at::Tensor target;  ///< [N, C, h, w]
    at::Tensor source;  ///< [N, C, h, w]
};

/// Predicts both in one batch of two rows for each image; texts have one row.
PromptPair predict_pair(const DiffusionModel& pipeline, const NoisedLatents& start,
                        const TextEmbedding& target_text, const TextEmbedding& source_text);

class RelativeDirection : public Guidance {
  public:
    RelativeDirection(std::shared_ptr<const DiffusionModel> pipeline,
                      const std::string& source_prompt, const std::string& target_prompt,
                      const GuidanceOptions& options);
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
    /// For use without a learned source.
    void shift_source(const TextEmbedding& shift) override;
    std::optional<TextDirection> text_direction() const override;
    NamedTensors state() const override;
    void load_state(const NamedTensors& state) override;

  private:
    /// Returns the current source, one row: the prompt's embedding, or its adjusted version.
    TextEmbedding source() const;
    PromptPair predict(const NoisedLatents& start, std::int64_t iteration);

    std::shared_ptr<const DiffusionModel> pipeline_;
    GuidanceOptions options_;
    TextEmbedding target_text_;  ///< one row, as the source's
    TextEmbedding source_text_;
    TextEmbedding source_shift_;  ///< undefined before the first shift
    std::optional<LearnedSource> learned_source_;
};

}  // namespace item3d
