// Export of the prior as a folder in the diffusers layout, weights in fp16.
#pragma once

#include "item3d/networks/diffusion/autoencoder_tiny.h"
#include "item3d/networks/diffusion/scheduler_config.h"
#include "item3d/networks/diffusion/unet.h"
#include "item3d/networks/vision_language/clip_text.h"
#include "item3d/text/clip_tokenizer.h"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace item3d {

/// Writes tokenizer/, vae/ and model_index.json.
void export_autoencoder(const std::filesystem::path& folder, const AutoencoderTiny& autoencoder,
                        const ClipTokenizer& tokenizer);

/// Writes unet/, text_encoder/, scheduler/ and prior.json, whose member "train" is `train`. Other
/// members of an existing prior.json are kept. resolution: edge of the prior's images, in pixels.
/// Every file is written atomically.
void export_diffusion(const std::filesystem::path& folder, const UNet2DCondition& unet,
                      const ClipTextModel& text, const SchedulerConfig& scheduler, int resolution,
                      const nlohmann::json& train);

}  // namespace item3d
