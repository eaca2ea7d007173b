// CLIP (Radford et al. 2021) from pictures and sentences to embeddings, without its layers'
// headers.
#pragma once

#include "item3d/networks/vision_language/image_processor.h"
#include "item3d/tensors/tensor.h"
#include "item3d/text/clip_tokenizer.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

class ClipModelImpl;  // clip_model.h

/// The model with all that pictures and sentences need on their way to it.
class Clip {
  public:
    /// Reads FOLDER (config.json, model.*, preprocessor_config.json, vocab.json, merges.txt, ...).
    /// Throws InputError naming the file for anything missing or unsupported.
    static Clip load(const std::filesystem::path& folder, at::Device device = at::kCPU,
                     at::ScalarType dtype = at::kFloat);

    /// The same for many pictures: linear layers are packed (packable_linear.h) where the processor
    /// gains by it, and those alone compute in `dtype` then.
    static Clip load_to_run(const std::filesystem::path& folder, at::Device device,
                            at::ScalarType dtype);

    /// Warns where embed_texts() leaves out the end of a text because it is too long.
    void warn_of_lost_words(const std::string& subject, const std::string& text) const;
    /// [N, D] float32, each of length 1.
    at::Tensor embed_texts(const std::vector<std::string>& texts) const;
    /// images [N, 3, H, W] sRGB in [0, 1] -> [N, D] float32, each of length 1. Differentiable in
    /// the images.
    at::Tensor embed_images(const at::Tensor& images) const;

    const ClipTokenizer& tokenizer() const { return *tokenizer_; }

  private:
    int text_length() const;  ///< tokens that the network reads

    std::shared_ptr<ClipModelImpl> model_;
    std::shared_ptr<ClipTokenizer> tokenizer_;
    std::shared_ptr<ImageProcessor> processor_;
    at::Device device_ = at::kCPU;
};

}  // namespace item3d
