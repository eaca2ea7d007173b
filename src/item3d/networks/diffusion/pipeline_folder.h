// Folder of a pipeline in the diffusers layout: its index, and writers of its parts.
#pragma once

#include "item3d/networks/diffusion/autoencoder.h"
#include "item3d/networks/diffusion/unet.h"
#include "item3d/networks/vision_language/clip_text.h"

#include <filesystem>

namespace item3d {

/// Contents of model_index.json.
struct PipelineIndex {
    bool has_second_text_encoder = false;  ///< true for SDXL
    bool force_zeros_for_empty_prompt = false;

    /// Throws InputError if there is no folder, no index, or a part of an unsupported class.
    static PipelineIndex read(const std::filesystem::path& folder);
};

/// These functions write a pipeline's parts, each into a sub-folder that must exist. Weights are
/// written as `dtype`.
void save_unet(const std::filesystem::path& folder, const UNet2DCondition& unet,
               at::ScalarType dtype = at::kHalf);
void save_autoencoder(const std::filesystem::path& folder, const Autoencoder& autoencoder,
                      at::ScalarType dtype = at::kHalf);
void save_clip_text(const std::filesystem::path& folder, const ClipTextModel& model,
                    at::ScalarType dtype = at::kHalf);

}  // namespace item3d
