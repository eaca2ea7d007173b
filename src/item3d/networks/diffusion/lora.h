// LoRA (Hu et al. 2021): low-rank changes of a network's weights, added to them for good.
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

/// The networks that a LoRA may change; the second text encoder is SDXL's and may be empty.
struct LoraTargets {
    UNet2DCondition unet{nullptr};
    ClipTextModel text_encoder{nullptr};
    ClipTextModel text_encoder_2{nullptr};
};

/// For every layer of every file W += scale * alpha / rank * up x down, summed in float32 and cast
/// once to the type of the weights. alpha is the file's tensor, else that of diffusers'
/// "lora_adapter_metadata" or of PEFT's adapter_config.json beside an adapter_model.safetensors,
/// else the rank. Embeddings that come bundled with it are left out, with a note. Names as
/// lora_names.h says, linear layers and convolutions. Throws InputError that names file and tensor,
/// before any weight is changed, for a tensor that fits nothing, ranks or shapes that do not agree,
/// and adapters of other kinds.
void fuse_loras(const std::vector<LoraFile>& files, const LoraTargets& targets);

}  // namespace item3d
