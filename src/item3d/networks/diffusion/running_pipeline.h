// A pipeline that runs and does nothing else, in as little memory as it can.
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/networks/diffusion/pipeline_extras.h"

#include <filesystem>
#include <map>

namespace item3d {

/// What a pipeline that only runs is asked.
struct RunNeeds {
    std::vector<std::string> prompts;  ///< all that encode_text() will be asked for
    bool decoder = true;               ///< whether decode_image() will be
};

class RunningPipeline : public DiffusionModel {
  public:
    /// The pipeline of a folder, with its extras. The text encoders are loaded, asked and released
    /// before the other networks are loaded (a LoRA wants all at once); convolutions release
    /// weights of which they keep a packed copy. Throws as Pipeline::load() and Pipeline::add().
    static RunningPipeline load(const std::filesystem::path& folder, at::Device device,
                                at::ScalarType dtype, const PipelineExtras& extras,
                                const RunNeeds& needs);

    /// Of the prompts that load() and learn_prompts() were told, and of no text.
    TextEmbedding encode_text(const std::vector<std::string>& prompts) const override;

    /// Loads the text encoders once more where a prompt is new, and releases them. A LoRA is fused
    /// into text encoders and U-Net together, so a pipeline with one cannot learn.
    void learn_prompts(const std::vector<std::string>& prompts);
    bool can_learn_prompts() const { return extras_.lora.empty(); }
    /// Whether encode_text() is ready for all of these.
    bool knows_prompts(const std::vector<std::string>& prompts) const;
    /// The same networks for another edit, with predicted_rows() counted from 0.
    RunningPipeline renewed() const;

  private:
    std::filesystem::path folder_;
    PipelineExtras extras_;
    std::map<std::string, TextEmbedding> encoded_;  ///< a row each
};

}  // namespace item3d
