// The prior's autoencoder and its training.
#pragma once

#include "item3d/networks/diffusion/autoencoder_tiny.h"
#include "item3d/prior/data/views.h"
#include "item3d/prior/training/settings.h"
#include "item3d/tensors/tensor.h"

#include <memory>

namespace item3d {

/// Training images of the autoencoder.
struct ImageData {
    at::Tensor images;   ///< [N, S, S, 3] uint8 sRGB
    at::Tensor covered;  ///< [N, S, S] uint8
};

/// Returns a config that downsamples images of `resolution` pixels to latents of latent_size.
AutoencoderTinyConfig prior_autoencoder_config(int resolution = prior_image_size);

/// Autoencoder with its PSNR in dB over the held-out images.
struct TrainedAutoencoder {
    std::shared_ptr<AutoencoderTiny> model;
    double psnr = 0;
    double object_psnr = 0;  ///< PSNR on object pixels only
};
/// Trains the autoencoder (or, when resuming, reads it) and sets its scaling factor.
TrainedAutoencoder train_autoencoder(const ImageData& images, const ImageData& held_out,
                                     const TrainSettings& settings);

}  // namespace item3d
