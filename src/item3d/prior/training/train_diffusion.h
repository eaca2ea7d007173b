// Joint training of the prior's text encoder and U-Net.
#pragma once

#include "item3d/networks/diffusion/unet.h"
#include "item3d/networks/vision_language/clip_text.h"
#include "item3d/prior/training/settings.h"
#include "item3d/tensors/safetensors.h"
#include "item3d/tensors/tensor.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <filesystem>

namespace item3d {

/// Encoded training data of the U-Net, for N images.
struct LatentData {
    /// Returns the tensors under their names in files. from_tensors() is the inverse. It throws
    /// InputError that names the file, for tensors that do not match or tokens beyond the
    /// vocabulary.
    NamedTensors tensors() const;
    static LatentData from_tensors(const NamedTensors& tensors, std::size_t vocabulary,
                                   const std::filesystem::path& file);

    at::Tensor latents;       ///< [N, latent_channels, 16, 16] fp16, scaled
    at::Tensor cells;         ///< [N, 7, 16, 16] fp16, shape_cells()
    at::Tensor tokens;        ///< [N, text_length] int16
    at::Tensor empty_tokens;  ///< [text_length] int16, the empty prompt
    /// [N, latent_channels, 16, 16] fp16, not scaled: latents of the images that instructions
    /// change. Undefined for a U-Net that is conditioned on a shape.
    at::Tensor sources;
};

UNet2DConditionConfig prior_unet_config(const TrainSettings& settings = {});
ClipTextConfig prior_text_config(int vocabulary, int start_of_text, int end_of_text);

/// Configurations of the jointly trained networks.
struct DiffusionConfig {
    UNet2DConditionConfig unet;
    ClipTextConfig text;
};

/// Trains text encoder and U-Net together. Process 0 exports the networks periodically and returns
/// {"samples", "loss", "seconds", ...}. Throws Interrupted after writing a checkpoint.
nlohmann::json train_diffusion(const LatentData& data, const TrainSettings& settings,
                               const DiffusionConfig& networks, const nlohmann::json& so_far);

}  // namespace item3d
