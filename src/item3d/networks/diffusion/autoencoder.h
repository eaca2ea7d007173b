// The autoencoders between pictures and latents: what both kinds have in common.
#pragma once

#include "item3d/core/config.h"
#include "item3d/networks/layers/load_parameters.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/module.h>

#include <filesystem>
#include <memory>

namespace item3d {

/// What a pipeline needs of either kind. A torch module: its parameters have diffusers' names.
class Autoencoder : public torch::nn::Module {
  public:
    /// images [N, 3, H, W] in [-1, 1] -> latents [N, latent_channels, h, w], not scaled; the mean
    /// where the encoder gives a distribution.
    virtual at::Tensor encode(const at::Tensor& images) = 0;
    /// Unscaled latents -> images [N, 3, H, W], about [-1, 1], not clamped.
    virtual at::Tensor decode(const at::Tensor& latents) = 0;

    /// While on, a gradient through encode() takes less memory and more time, where the network is
    /// large enough for that to matter.
    virtual void recompute_in_backward(bool on) { (void)on; }

    /// The U-Net sees (latent - shift_factor) * scaling_factor.
    virtual double scaling_factor() const = 0;
    virtual double shift_factor() const = 0;
    virtual int latent_channels() const = 0;
    /// Image pixels a latent cell, along one side.
    virtual int downscale() const = 0;
    /// A config.json that diffusers can read.
    virtual nlohmann::json config_json() const = 0;
};

/// Reads FOLDER/config.json (its _class_name decides the kind) and
/// FOLDER/diffusion_pytorch_model.*; old spellings of the attention's names are understood. Without
/// a decoder, an AutoencoderKL's is not read and takes no memory. Throws InputError.
std::shared_ptr<Autoencoder> load_autoencoder(const std::filesystem::path& folder,
                                              at::Device device = at::kCPU,
                                              at::ScalarType dtype = at::kFloat,
                                              bool with_decoder = true,
                                              WeightUse use = WeightUse::any);

}  // namespace item3d
