// InstructPix2Pix (Brooks et al. 2023): a U-Net of 8 input channels, the noisy latents and those of
// the image to edit, and its guidance by both.
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

/// Returns none + text (full - image) + image_scale (image - none), in the network's own output.
at::Tensor three_way(const at::Tensor& full, const at::Tensor& image, const at::Tensor& none,
                     InstructScales scales);

/// A model with one encoded instruction.
class InstructedModel {
  public:
    /// Throws InputError if the model takes no instructions.
    InstructedModel(const DiffusionModel& model, const std::string& instruction,
                    const std::string& negative_prompt, InstructScales scales,
                    const std::string& subject);

    /// Encodes images [N, 3, H, W] sRGB in [0, 1] to [N, C, h, w], not scaled, as the U-Net's
    /// input.
    at::Tensor image_latents(const at::Tensor& images) const;
    /// Maps latents [N, C, h, w] to the network's output, in 3 N rows of the U-Net.
    at::Tensor operator()(const at::Tensor& latents, double timestep,
                          const at::Tensor& image_latents) const;

    /// Edits one image: `current` [1, 3, H, W] is noised to the first of `steps` DDIM steps below
    /// timestep `from`, and denoised by the instruction and `original`. (The published code, too,
    /// sets the schedule's length to `from`.) noise: [1, C, h, w]. Returns [1, 3, H, W] in [0, 1].
    at::Tensor edit(const at::Tensor& current, const at::Tensor& original, std::int64_t from,
                    int steps, const at::Tensor& noise) const;

    const DiffusionModel& model() const { return model_; }

  private:
    const DiffusionModel& model_;
    TextEmbedding text_, none_;
    InstructScales scales_;
};

}  // namespace item3d
