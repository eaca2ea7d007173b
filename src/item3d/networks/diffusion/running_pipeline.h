// Inference-only pipeline that uses as little memory as it can.
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/networks/diffusion/pipeline_extras.h"

#include <filesystem>
#include <map>

namespace item3d {

/// Requirements of an inference-only pipeline.
struct RunNeeds {
    std::vector<std::string> prompts;  ///< all prompts that encode_text() will get
    bool decoder = true;               ///< true if decode_image() will be called
};

class RunningPipeline : public DiffusionModel {
  public:
    /// Loads the pipeline of a folder with its extras. The text encoders are loaded, run and
    /// released before the other networks are loaded; with a LoRA, all networks are loaded at once.
    /// Convolutions release their weights after packing a copy of them. Throws like
    /// Pipeline::load() and Pipeline::add().
    static RunningPipeline load(const std::filesystem::path& folder, at::Device device,
                                at::ScalarType dtype, const PipelineExtras& extras,
                                const RunNeeds& needs);

    /// Returns the embeddings of prompts that were given to load() or learn_prompts(), or of no
    /// text.
    TextEmbedding encode_text(const std::vector<std::string>& prompts) const override;

    /// Loads the text encoders again if a prompt is new, and releases them. Unavailable with a
    /// LoRA, because a LoRA is fused into text encoders and U-Net together.
    void learn_prompts(const std::vector<std::string>& prompts);
    bool can_learn_prompts() const { return extras_.lora.empty(); }
    /// True if encode_text() is ready for all of these prompts.
    bool knows_prompts(const std::vector<std::string>& prompts) const;
    /// Returns the same networks for another edit, with predicted_rows() counted from 0.
    RunningPipeline renewed() const;

  private:
    std::filesystem::path folder_;
    PipelineExtras extras_;
    std::map<std::string, TextEmbedding> encoded_;  ///< by prompt; each has a first dimension of 1
};

}  // namespace item3d
