// Networks of a pipeline that work on latents: U-Net, autoencoder and optional ControlNet.
#pragma once

#include "item3d/networks/diffusion/autoencoder.h"
#include "item3d/networks/diffusion/controlnet.h"
#include "item3d/networks/diffusion/noise_schedule.h"
#include "item3d/networks/diffusion/text_encoders.h"
#include "item3d/networks/diffusion/unet.h"

#include <filesystem>
#include <memory>

namespace item3d {

/// Number of values in SDXL's size condition: original height and width, top and left of the crop,
/// target height and width.
inline constexpr int image_sizes = 6;

struct DiffusionNetworks {
    UNet2DCondition unet{nullptr};
    std::shared_ptr<Autoencoder> vae;
    NoiseSchedule scheduler;
    ControlNet controlnet{nullptr};  ///< may be empty
    double controlnet_scale = 1;     ///< factor of the ControlNet's residuals

    /// Reads the sub-folders unet, vae and scheduler; weights are cast once to `dtype`. Throws
    /// InputError that names the file for a part that is missing, of the wrong shape, unsupported,
    /// or of a model other than that of `text`.
    static DiffusionNetworks load(const std::filesystem::path& folder, const TextEncoders& text,
                                  at::Device device = at::kCPU, at::ScalarType dtype = at::kFloat,
                                  bool with_decoder = true, WeightUse use = WeightUse::any);

    at::Device device() const { return unet->parameters()[0].device(); }
    int latent_channels() const { return vae->latent_channels(); }
    /// Number of the U-Net's input channels beyond those of the latents.
    int condition_channels() const { return unet->config().in_channels - latent_channels(); }
};

/// Reorders convolution weights for channels-last feature maps.
void use_channels_last(torch::nn::Module& module);

}  // namespace item3d
