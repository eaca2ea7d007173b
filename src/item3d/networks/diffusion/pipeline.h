// Complete text-to-image diffusion model in the diffusers layout; it can be changed and saved.
#pragma once

#include "item3d/networks/diffusion/diffusion_model.h"
#include "item3d/networks/diffusion/pipeline_extras.h"

#include <filesystem>

namespace item3d {

struct TextEncoders;  // text_encoders.h

class Pipeline : public DiffusionModel {
  public:
    /// Reads model_index.json and its sub-folders (tokenizer, text_encoder, unet, vae, scheduler;
    /// for SDXL tokenizer_2 and text_encoder_2 too). Weights are cast once to `dtype` (text
    /// encoders and schedules stay float32). Throws InputError that names the file for a part that
    /// is missing, of the wrong shape, or unsupported.
    static Pipeline load(const std::filesystem::path& folder, at::Device device = at::kCPU,
                         at::ScalarType dtype = at::kFloat);
    /// Applies extras to the networks, whose weights keep their types. Throws InputError that names
    /// the file or option for an extra that cannot be read or does not fit this pipeline.
    void add(const PipelineExtras& extras);
    /// Writes the layout that load() reads, with weights as `dtype` (float32 or float16). Each file
    /// is written atomically, and model_index.json last, so a folder with that file is complete.
    void save(const std::filesystem::path& folder, at::ScalarType dtype = at::kHalf) const;

    TextEmbedding encode_text(const std::vector<std::string>& prompts) const override;

    TextEncoders& text() { return *text_; }
    const TextEncoders& text() const { return *text_; }
    DiffusionNetworks& networks() { return *networks_; }
    using DiffusionModel::networks;

  private:
    std::shared_ptr<TextEncoders> text_;
};

}  // namespace item3d
