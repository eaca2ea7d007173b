// CLIPSeg, which converts images and sentences to masks. This header does not include the headers
// of CLIPSeg's layers.
#pragma once

#include "item3d/networks/vision_language/image_processor.h"
#include "item3d/tensors/tensor.h"
#include "item3d/text/clip_tokenizer.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

class ClipSegModelImpl;  // clip_seg.h

/// A CLIPSeg network with its tokenizer and image processor.
class Segmenter {
  public:
    /// Reads FOLDER (config.json, model.*, preprocessor_config.json, vocab.json, merges.txt, ...).
    /// Throws InputError that names the file for a part that is missing, unsupported or of another
    /// class.
    static Segmenter load(const std::filesystem::path& folder, at::Device device = at::kCPU,
                          at::ScalarType dtype = at::kFloat);

    /// Reads FOLDER for inference on many images: linear layers are packed (packable_linear.h)
    /// where that is faster. Only packed layers then compute in `dtype`.
    static Segmenter load_to_run(const std::filesystem::path& folder, at::Device device,
                                 at::ScalarType dtype);

    /// Segments each image by each prompt. images are [N, 3, H, W] sRGB in [0, 1]; there are P
    /// prompts, at least one. Returns logits [N, P, h, w] float32, whose sigmoid is the probability
    /// that the prompt names the pixel. h and w do not depend on H and W, but are the network's
    /// own. Pixel (0, 0) is at the same corner in images and logits. Differentiable in the images.
    at::Tensor segment(const at::Tensor& images, const std::vector<std::string>& prompts) const;

    /// Returns the result of segment() as probabilities in [0, 1] at the images' own size: [N, P,
    /// H, W].
    at::Tensor masks(const at::Tensor& images, const std::vector<std::string>& prompts) const;

    /// Warns if segment() truncates the prompt.
    void warn_of_lost_words(const std::string& subject, const std::string& prompt) const;

    const ClipTokenizer& tokenizer() const { return *tokenizer_; }

  private:
    int text_length() const;  ///< number of tokens that the network reads

    std::shared_ptr<ClipSegModelImpl> model_;
    std::shared_ptr<ClipTokenizer> tokenizer_;
    std::shared_ptr<ImageProcessor> processor_;
    at::Device device_ = at::kCPU;
};

}  // namespace item3d
