// The networks of a pipeline that see latents: U-Net, autoencoder, and a ControlNet where one is
// added.
#pragma once

#include "item3d/networks/diffusion/autoencoder.h"
#include "item3d/networks/diffusion/controlnet.h"
#include "item3d/networks/diffusion/noise_schedule.h"
#include "item3d/networks/diffusion/text_encoders.h"
#include "item3d/networks/diffusion/unet.h"

#include <filesystem>
#include <memory>

namespace item3d {

/// Numbers that SDXL is told of a picture: original height and width, top and left of the crop,
/// target height and width.
inline constexpr int picture_sizes = 6;

struct DiffusionNetworks {
    UNet2DCondition unet{nullptr};
    std::shared_ptr<Autoencoder> vae;
    NoiseSchedule scheduler;
    ControlNet controlnet{nullptr};  ///< may be empty
    double controlnet_scale = 1;     ///< of its residuals

    /// Reads the sub-folders unet, vae and scheduler; weights are cast once to `dtype`. Throws
    /// InputError naming the file for anything missing, of the wrong shape, unsupported, or of
    /// another model than `text`.
    static DiffusionNetworks load(const std::filesystem::path& folder, const TextEncoders& text,
                                  at::Device device = at::kCPU, at::ScalarType dtype = at::kFloat,
                                  bool with_decoder = true, WeightUse use = WeightUse::any);

    at::Device device() const { return unet->parameters()[0].device(); }
    int latent_channels() const { return vae->latent_channels(); }
    /// Input channels of the U-Net beyond the latents'.
    int condition_channels() const { return unet->config().in_channels - latent_channels(); }
};

/// Puts convolution weights in the order that convolutions on channels-last maps want.
void use_channels_last(torch::nn::Module& module);

}  // namespace item3d
