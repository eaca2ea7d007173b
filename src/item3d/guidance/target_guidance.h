// Base classes of methods that use the target prompt but not the source prompt.
#pragma once

#include "item3d/guidance/guidance.h"

namespace item3d {

/// Base of methods that compare the target's prediction with one other prediction.
class TargetGuidance : public Guidance {
  public:
    TargetGuidance(std::shared_ptr<const DiffusionModel> pipeline, const std::string& target_prompt,
                   const GuidanceOptions& options);

  protected:
    std::shared_ptr<const DiffusionModel> pipeline_;
    GuidanceOptions options_;
    TextEmbedding target_text_;  ///< these embeddings have one row each
    TextEmbedding base_text_;    ///< the negative prompt, or none
};

/// Base of methods that need two further predictions, one without a prompt and one for a negative
/// prompt. If the user gives no negative prompt, it is default_negative_prompt().
class NegativeGuidance : public Guidance {
  public:
    NegativeGuidance(std::shared_ptr<const DiffusionModel> pipeline,
                     const std::string& target_prompt, const GuidanceOptions& options);

  protected:
    std::shared_ptr<const DiffusionModel> pipeline_;
    GuidanceOptions options_;
    TextEmbedding target_text_;  ///< these embeddings have one row each
    TextEmbedding no_text_;
    TextEmbedding negative_text_;
};

}  // namespace item3d
