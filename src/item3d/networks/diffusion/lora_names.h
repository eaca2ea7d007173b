// Tensor names in the LoRA files of different trainers.
#pragma once

#include "item3d/networks/diffusion/unet.h"
#include "item3d/networks/vision_language/clip_text.h"

#include <map>
#include <optional>
#include <string>

namespace item3d {

enum class LoraNetwork { unet, text_encoder, text_encoder_2 };
enum class LoraRole { down, up, alpha };

/// Parts of a tensor's name.
struct LoraTensorName {
    LoraNetwork network;
    std::string module;  ///< the module's name in the file, without the network's prefix
    LoraRole role;
};

/// Parses names of diffusers and PEFT ("unet.X.lora_A.weight", "unet.X.lora.down.weight",
/// "text_encoder.X.lora_linear_layer.up.weight", "X.processor.to_q_lora.down.weight") and of kohya
/// ("lora_unet_X.lora_down.weight", "lora_te_", "lora_te1_", "lora_te2_", "X.alpha"). Returns
/// nullopt for a name of another form.
std::optional<LoraTensorName> parse_lora_name(const std::string& name);

/// Returns the kind of adapter other than LoRA ("LoHa") that has tensors of this name; "" if
/// unknown.
std::string other_adapter_kind(const std::string& name);

/// Map from every spelling of a module's name in LoRA files to the module. It contains only modules
/// with a matrix or a convolution. The spellings for the U-Net are diffusers' names, with dots or
/// with underscores, and the names in the original Stable Diffusion code
/// ("input_blocks_1_1_proj_in").
using LoraSpellings = std::map<std::string, std::string>;

LoraSpellings unet_spellings(const UNet2DConditionImpl& unet);
LoraSpellings text_encoder_spellings(const ClipTextModelImpl& text_encoder);

/// Returns the module of a name that is spelled with dots or underscores; nullopt if there is none.
std::optional<std::string> find_module(const LoraSpellings& spellings, const std::string& name);

/// Returns the token of an embedding that some trainers bundle with a LoRA's tensors
/// ("bundle_emb.WORD.clip_l"), or "".
std::string bundled_embedding(const std::string& name);

}  // namespace item3d
