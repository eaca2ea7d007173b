// InstructPix2Pix (Brooks et al. 2023): a U-Net with 8 input channels, which are the noisy latents
// and the latents of the image to edit. Its guidance has one scale for the instruction and one for
// the image.
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/tensors/tensor.h"

#include <cstdint>
#include <string>

namespace item3d {

/// True if the U-Net takes an image's latents as additional input.
bool takes_instructions(const DiffusionModel& model);

/// Guidance scales of the instruction and of the image.
struct InstructScales {
    float text = 7.5f;
    float image = 1.5f;
};

/// Returns none + scales.text (full - image) + scales.image (image - none). The three tensors are
/// outputs of the network: `full` with instruction and image, `image` with the image only, `none`
/// with neither.
at::Tensor three_way(const at::Tensor& full, const at::Tensor& image, const at::Tensor& none,
                     InstructScales scales);

/// A model with one encoded instruction.
class InstructedModel {
  public:
    /// Throws InputError if the model takes no instructions.
    InstructedModel(const DiffusionModel& model, const std::string& instruction,
                    const std::string& negative_prompt, InstructScales scales,
                    const std::string& subject);

    /// Encodes images [N, 3, H, W], sRGB in [0, 1], to latents [N, C, h, w] for the U-Net's input.
    /// They are not multiplied by the VAE's scaling factor.
    at::Tensor image_latents(const at::Tensor& images) const;
    /// Maps latents [N, C, h, w] to the guided output of the network (three_way()). The U-Net
    /// computes a batch of 3 N rows.
    at::Tensor operator()(const at::Tensor& latents, double timestep,
                          const at::Tensor& image_latents) const;

    /// Edits the image `current` [1, 3, H, W] and returns the result, [1, 3, H, W] in [0, 1]. The
    /// image is noised to the first of `steps` DDIM steps below timestep `from`, and then denoised,
    /// guided by the instruction and by the image `original`. (The published code, too, sets the
    /// schedule's length to `from`.) noise: [1, C, h, w].
    at::Tensor edit(const at::Tensor& current, const at::Tensor& original, std::int64_t from,
                    int steps, const at::Tensor& noise) const;

    const DiffusionModel& model() const { return model_; }

  private:
    const DiffusionModel& model_;
    TextEmbedding text_, none_;
    InstructScales scales_;
};

}  // namespace item3d
