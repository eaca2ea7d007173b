// The prior's autoencoder and its training.
#pragma once

#include "item3d/networks/diffusion/autoencoder_tiny.h"
#include "item3d/prior/data/views.h"
#include "item3d/prior/training/settings.h"
#include "item3d/tensors/tensor.h"

#include <memory>

namespace item3d {

/// Pictures for the autoencoder.
struct PictureData {
    at::Tensor images;   ///< [N, S, S, 3] uint8 sRGB
    at::Tensor covered;  ///< [N, S, S] uint8
};

/// Downsamples pictures of that resolution to latent_size.
AutoencoderTinyConfig prior_autoencoder_config(int resolution = picture_size);

/// Trains (or, when resuming, reads) the autoencoder. Sets its scaling factor. Returns it with its
/// held-out PSNR in dB, over `held_out` pictures.
struct TrainedAutoencoder {
    std::shared_ptr<AutoencoderTiny> model;
    double psnr = 0;
    double object_psnr = 0;  ///< of object pixels alone
};
TrainedAutoencoder train_autoencoder(const PictureData& pictures, const PictureData& held_out,
                                     const TrainSettings& settings);

}  // namespace item3d
