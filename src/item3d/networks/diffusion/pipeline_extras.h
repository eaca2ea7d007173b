// Extras of a loaded pipeline: LoRAs, learned tokens, a ControlNet, another autoencoder.
#pragma once

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace item3d {

struct DiffusionNetworks;  // diffusion_networks.h
struct TextEncoders;       // text_encoders.h

inline constexpr float max_controlnet_scale = 10;

struct PipelineExtras {
    std::vector<std::string> lora;       ///< FILE or FILE:SCALE
    std::vector<std::string> embedding;  ///< FILE or FILE:TOKEN
    std::string controlnet;              ///< folder of a depth ControlNet; "" for none
    float controlnet_scale = 1;          ///< factor of the ControlNet's residuals, from 0
    /// Folder of another autoencoder; "" for the pipeline's own.
    std::string vae;
};

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE_WITH_DEFAULT(PipelineExtras, lora, embedding, controlnet,
                                                controlnet_scale, vae)

/// Fuses LoRAs into U-Net and text encoders, whose weights keep their types. Like the two functions
/// below, throws InputError that names the file or option for an extra that cannot be read or does
/// not fit the pipeline.
void fuse_loras(const PipelineExtras& extras, TextEncoders& text, DiffusionNetworks& networks);
/// Adds learned tokens (textual inversion).
void add_embeddings(const PipelineExtras& extras, TextEncoders& text);
/// Replaces the autoencoder and adds the ControlNet. The decoder is loaded only if with_decoder.
void change_networks(const PipelineExtras& extras, DiffusionNetworks& networks, bool with_decoder);

}  // namespace item3d
