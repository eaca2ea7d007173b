// LoRA (Hu et al. 2021): low-rank changes of a network's weights, fused permanently into them.
#pragma once

#include "item3d/networks/diffusion/unet.h"
#include "item3d/networks/vision_language/clip_text.h"

#include <filesystem>
#include <vector>

namespace item3d {

struct LoraFile {
    std::filesystem::path path;
    double scale = 1;
};

/// Networks that a LoRA may change; the second text encoder is SDXL's and may be empty.
struct LoraTargets {
    UNet2DCondition unet{nullptr};
    ClipTextModel text_encoder{nullptr};
    ClipTextModel text_encoder_2{nullptr};
};

/// Adds, for every layer in every file, scale * alpha / rank * up x down to the layer's weights.
/// The sum is computed in float32 and cast once to the weights' type. alpha is a tensor of the
/// file, or else a value in diffusers' "lora_adapter_metadata" or in PEFT's adapter_config.json
/// beside an adapter_model.safetensors, or else the rank. Tensor names are those of lora_names.h;
/// layers are linear or convolutions. Bundled embeddings are skipped with a note. Throws InputError
/// that names file and tensor, before any weight is changed, for an unmatched tensor, inconsistent
/// ranks or shapes, or an adapter of another kind.
void fuse_loras(const std::vector<LoraFile>& files, const LoraTargets& targets);

}  // namespace item3d
