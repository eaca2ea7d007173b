// What a user may add to a pipeline that is loaded: LoRA, learned tokens, a ControlNet, another
// autoencoder.
#pragma once

#include "item3d/networks/diffusion/pipeline.h"

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

struct PipelineExtras {
    std::vector<std::string> lora;       ///< FILE or FILE:SCALE
    std::vector<std::string> embedding;  ///< FILE or FILE:TOKEN
    std::string controlnet;              ///< folder of a depth ControlNet; "": none
    float controlnet_scale = 1;          ///< of its residuals
    std::string vae;                     ///< folder of another autoencoder; "": the pipeline's own
};

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(PipelineExtras, lora, embedding, controlnet,
                                                controlnet_scale, vae)

/// Changes the pipeline's networks, in the types that they have. Throws InputError that names the
/// file or option for what cannot be read or does not fit this pipeline.
void apply_extras(Pipeline& pipeline, const PipelineExtras& extras);

/// What a pipeline that runs and does nothing else is asked.
struct RunNeeds {
    std::vector<std::string> prompts;  ///< all that encode_text() will be asked for
    bool decoder = true;               ///< whether decode_image() will be
};

/// The pipeline of a folder, with its extras, in as little memory as it can run in: the text
/// encoders are loaded, asked and let go before the other networks are loaded (a LoRA wants all at
/// once), see Pipeline::keep_texts() and give_up_weights(). Throws as Pipeline::load() and
/// apply_extras().
Pipeline load_to_run(const std::filesystem::path& folder, torch::Device device, torch::Dtype dtype,
                     const PipelineExtras& extras, const RunNeeds& needs);

}  // namespace item3d
