// Base class of the autoencoders between images and latents.
#pragma once

#include "item3d/core/config.h"
#include "item3d/networks/layers/load_parameters.h"
#include "item3d/tensors/tensor.h"

#include <torch/nn/module.h>

#include <filesystem>
#include <memory>

namespace item3d {

/// The interface of an autoencoder that a pipeline uses. It is a torch module whose parameters have
/// diffusers' names.
class Autoencoder : public torch::nn::Module {
  public:
    /// Encodes images [N, 3, H, W] in [-1, 1] to unscaled latents [N, latent_channels, h, w]; an
    /// encoder that gives a distribution returns its mean.
    virtual at::Tensor encode(const at::Tensor& images) = 0;
    /// Decodes unscaled latents to images [N, 3, H, W] in about [-1, 1], not clamped.
    virtual at::Tensor decode(const at::Tensor& latents) = 0;

    /// Turns recomputation of activations in encode()'s backward pass on or off. It takes less
    /// memory and more time. Small networks ignore the setting.
    virtual void recompute_in_backward(bool on) { (void)on; }

    /// Constants of the conversion of latents to the U-Net's input: (latent - shift_factor) *
    /// scaling_factor.
    virtual double scaling_factor() const = 0;
    virtual double shift_factor() const = 0;
    virtual int latent_channels() const = 0;
    /// Image pixels per latent cell, along one side.
    virtual int downscale() const = 0;
    /// Returns a config.json that diffusers can read.
    virtual nlohmann::json config_json() const = 0;
};

/// Reads FOLDER/config.json (its _class_name selects the class) and
/// FOLDER/diffusion_pytorch_model.*; older names of the attention's tensors are accepted. Without
/// with_decoder, the decoder of an AutoencoderKL is not read and takes no memory. Throws
/// InputError.
std::shared_ptr<Autoencoder> load_autoencoder(const std::filesystem::path& folder,
                                              at::Device device = at::kCPU,
                                              at::ScalarType dtype = at::kFloat,
                                              bool with_decoder = true,
                                              WeightUse use = WeightUse::any);

}  // namespace item3d
