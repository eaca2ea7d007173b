// How LoRA files of different trainers name what they change.
#pragma once

#include "item3d/networks/diffusion/unet.h"
#include "item3d/networks/vision_language/clip_text.h"

#include <map>
#include <optional>
#include <string>

namespace item3d {

enum class LoraNetwork { unet, text_encoder, text_encoder_2 };
enum class LoraRole { down, up, alpha };

/// A tensor's name taken apart.
struct LoraTensorName {
    LoraNetwork network;
    std::string module;  ///< as the file spells it, without what names the network
    LoraRole role;
};

/// diffusers and PEFT ("unet.X.lora_A.weight", "unet.X.lora.down.weight",
/// "text_encoder.X.lora_linear_layer.up.weight", "X.processor.to_q_lora.down.weight") and kohya
/// ("lora_unet_X.lora_down.weight", "lora_te_", "lora_te1_", "lora_te2_", "X.alpha"). Nothing for a
/// name of another form.
std::optional<LoraTensorName> parse_lora_name(const std::string& name);

/// What kind of adapter other than LoRA has tensors of this name ("LoHa"); "" for none that we
/// know.
std::string other_adapter_kind(const std::string& name);

/// Every spelling of a module's name in LoRA files -> the module. Only modules with a matrix or a
/// convolution count. For the U-Net these are diffusers' names, the same with underscores, and
/// those of the original Stable Diffusion code ("input_blocks_1_1_proj_in").
using LoraSpellings = std::map<std::string, std::string>;

LoraSpellings unet_spellings(const UNet2DConditionImpl& unet);
LoraSpellings text_encoder_spellings(const ClipTextModelImpl& text_encoder);

/// The module of a name with dots or underscores, if any.
std::optional<std::string> find_module(const LoraSpellings& spellings, const std::string& name);

/// The word of an embedding that some trainers put beside a LoRA's tensors
/// ("bundle_emb.WORD.clip_l"), or "".
std::string bundled_embedding(const std::string& name);

}  // namespace item3d
