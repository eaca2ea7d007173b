// Relative direction (ITEM3D, section 3.3; symbols: guidance.h), in the form that takes two rows of
// the U-Net for each image:
//   g = omega(t) [ w (eps(y_target) - eps(y_source)) + lambda (eps(y_target) - eps) ].
//
// The term eps(empty) cancels in eps^w(y_target) - eps^w(y_source), so two rows suffice. A negative
// prompt in place of the empty prompt cancels as well. lambda is the anchor (--anchor), a pull to
// the target's own score. The paper's direction has no such pull (lambda is 0).
#pragma once

#include "item3d/guidance/guidance.h"
#include "item3d/guidance/learned_source.h"

#include <optional>

namespace item3d {

/// The predictions eps(y_target) and eps(y_source) for the same noised latents, as constants.
struct PromptPair {
    at::Tensor target;  ///< [N, C, h, w]
    at::Tensor source;  ///< [N, C, h, w]
};

/// Computes both predictions in one batch, which has two rows for each image. The texts have one
/// row.
PromptPair predict_pair(const DiffusionModel& pipeline, const NoisedLatents& start,
                        const TextEmbedding& target_text, const TextEmbedding& source_text);

class RelativeDirection : public Guidance {
  public:
    RelativeDirection(std::shared_ptr<const DiffusionModel> pipeline,
                      const std::string& source_prompt, const std::string& target_prompt,
                      const GuidanceOptions& options);
    GuidanceOutput step(const GuidanceInput& input, std::int64_t iteration) override;
    /// Must not be called if the source is learned.
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
    TextEmbedding target_text_;  ///< one row, as source_text_
    TextEmbedding source_text_;
    TextEmbedding source_shift_;  ///< undefined before the first shift
    std::optional<LearnedSource> learned_source_;
};

}  // namespace item3d
