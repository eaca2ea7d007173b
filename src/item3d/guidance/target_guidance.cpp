#include "item3d/guidance/target_guidance.h"

#include "item3d/guidance/prediction.h"

namespace item3d {

TargetGuidance::TargetGuidance(std::shared_ptr<const DiffusionModel> pipeline,
                               const std::string& target_prompt, const GuidanceOptions& options)
    : pipeline_(std::move(pipeline)),
      options_(options),
      target_text_(pipeline_->encode_text({target_prompt})),
      base_text_(encode_base(*pipeline_, options)) {}

NegativeGuidance::NegativeGuidance(std::shared_ptr<const DiffusionModel> pipeline,
                                   const std::string& target_prompt, const GuidanceOptions& options)
    : pipeline_(std::move(pipeline)),
      options_(options),
      target_text_(pipeline_->encode_text({target_prompt})),
      no_text_(pipeline_->encode_no_text()),
      negative_text_(encode_negative(*pipeline_, options)) {}

}  // namespace item3d
