// CLIPSeg from pictures and sentences to masks, without its layers' headers.
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

/// The network with all that pictures and prompts need on their way to it.
class Segmenter {
  public:
    /// Reads FOLDER (config.json, model.*, preprocessor_config.json, vocab.json, merges.txt, ...).
    /// Throws InputError naming the file for anything missing or unsupported, as a folder of
    /// another class.
    static Segmenter load(const std::filesystem::path& folder, at::Device device = at::kCPU,
                          at::ScalarType dtype = at::kFloat);

    /// The same for many pictures: linear layers are packed (packable_linear.h) where the processor
    /// gains by it, and those alone compute in `dtype` then.
    static Segmenter load_to_run(const std::filesystem::path& folder, at::Device device,
                                 at::ScalarType dtype);

    /// Where in each picture is what each prompt names. pictures [N, 3, H, W] sRGB in [0, 1];
    /// prompts: P, not empty. Returns logits [N, P, h, w] float32: the sigmoid of one is the
    /// probability that the pixel belongs to it. h and w are the network's own, whatever H and W
    /// are; pixel (0, 0) covers the same corner. Differentiable in the pictures.
    at::Tensor segment(const at::Tensor& pictures, const std::vector<std::string>& prompts) const;

    /// The same as probabilities in [0, 1] at the pictures' own size: [N, P, H, W].
    at::Tensor masks(const at::Tensor& pictures, const std::vector<std::string>& prompts) const;

    /// Warns where segment() leaves out the end of a prompt because it is too long.
    void warn_of_lost_words(const std::string& subject, const std::string& prompt) const;

    const ClipTokenizer& tokenizer() const { return *tokenizer_; }

  private:
    int text_length() const;  ///< tokens that the network reads

    std::shared_ptr<ClipSegModelImpl> model_;
    std::shared_ptr<ClipTokenizer> tokenizer_;
    std::shared_ptr<ImageProcessor> processor_;
    at::Device device_ = at::kCPU;
};

}  // namespace item3d
