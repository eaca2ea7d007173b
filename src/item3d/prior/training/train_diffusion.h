// The prior's text encoder and U-Net, trained together.
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

/// What the U-Net learns from, encoded. N rows.
struct LatentData {
    /// As they are called in a file. from_tensors() throws InputError, naming the file, for what
    /// does not belong together or has tokens beyond the vocabulary.
    NamedTensors tensors() const;
    static LatentData from_tensors(const NamedTensors& tensors, std::size_t vocabulary,
                                   const std::filesystem::path& file);

    at::Tensor latents;       ///< [N, latent_channels, 16, 16] fp16, scaled
    at::Tensor cells;         ///< [N, 7, 16, 16] fp16, shape_cells()
    at::Tensor tokens;        ///< [N, text_length] int16
    at::Tensor empty_tokens;  ///< [text_length] int16, the empty prompt
    /// [N, latent_channels, 16, 16] fp16, not scaled: of the pictures that instructions change.
    /// Undefined where a U-Net is told of a shape instead.
    at::Tensor sources;
};

UNet2DConditionConfig prior_unet_config(const TrainSettings& settings = {});
ClipTextConfig prior_text_config(int vocabulary, int start_of_text, int end_of_text);

/// What the networks that learn together look like.
struct DiffusionConfig {
    UNet2DConditionConfig unet;
    ClipTextConfig text;
};

/// Trains text encoder and U-Net together. Exports now and then, in process 0. Throws Interrupted
/// after writing a checkpoint. Returns {"samples", "loss", "seconds", ...} there.
nlohmann::json train_diffusion(const LatentData& data, const TrainSettings& settings,
                               const DiffusionConfig& networks, const nlohmann::json& so_far);

}  // namespace item3d
