// What the methods have in common that go by the target prompt and know no source.
#pragma once

#include "item3d/guidance/guidance.h"

namespace item3d {

/// Those that weigh the target against one other prediction.
class TargetGuidance : public Guidance {
  public:
    TargetGuidance(std::shared_ptr<const DiffusionModel> pipeline, const std::string& target_prompt,
                   const GuidanceOptions& options);

  protected:
    std::shared_ptr<const DiffusionModel> pipeline_;
    GuidanceOptions options_;
    TextEmbedding target_text_;  ///< one row each
    TextEmbedding base_text_;    ///< none, or the negative prompt
};

/// Those that need both the prediction without a prompt and one of a negative prompt, a general one
/// where none is given.
class NegativeGuidance : public Guidance {
  public:
    NegativeGuidance(std::shared_ptr<const DiffusionModel> pipeline,
                     const std::string& target_prompt, const GuidanceOptions& options);

  protected:
    std::shared_ptr<const DiffusionModel> pipeline_;
    GuidanceOptions options_;
    TextEmbedding target_text_;  ///< one row each
    TextEmbedding no_text_;
    TextEmbedding negative_text_;
};

}  // namespace item3d
