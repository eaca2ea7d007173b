// CLIP (Radford et al. 2021), which converts images and sentences to embeddings. This header does
// not include the headers of CLIP's layers.
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

/// A CLIP model with its tokenizer and image processor.
class Clip {
  public:
    /// Reads FOLDER (config.json, model.*, preprocessor_config.json, vocab.json, merges.txt, ...).
    /// Throws InputError that names the file for a part that is missing or unsupported.
    static Clip load(const std::filesystem::path& folder, at::Device device = at::kCPU,
                     at::ScalarType dtype = at::kFloat);

    /// Reads FOLDER for inference on many images: linear layers are packed (packable_linear.h)
    /// where that is faster. Only packed layers then compute in `dtype`.
    static Clip load_to_run(const std::filesystem::path& folder, at::Device device,
                            at::ScalarType dtype);

    /// Warns if embed_texts() truncates the text.
    void warn_of_lost_words(const std::string& subject, const std::string& text) const;
    /// Returns unit vectors [N, D] float32 of N texts.
    at::Tensor embed_texts(const std::vector<std::string>& texts) const;
    /// Returns unit vectors [N, D] float32 of images [N, 3, H, W] sRGB in [0, 1]. Differentiable in
    /// the images.
    at::Tensor embed_images(const at::Tensor& images) const;

    const ClipTokenizer& tokenizer() const { return *tokenizer_; }

  private:
    int text_length() const;  ///< number of tokens that the network reads

    std::shared_ptr<ClipModelImpl> model_;
    std::shared_ptr<ClipTokenizer> tokenizer_;
    std::shared_ptr<ImageProcessor> processor_;
    at::Device device_ = at::kCPU;
};

}  // namespace item3d
