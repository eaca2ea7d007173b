// Sentences for pictures, by BLIP or BLIP-2.
#pragma once

#include "item3d/tensors/tensor.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// Of a caption that is asked for once: three find a likelier one than one does.
inline constexpr int caption_beams = 3;

struct CaptionOptions {
    std::string prefix;       ///< what the caption goes on from, as in "a photo of"
    int beams = 1;            ///< 1: greedy
    int max_new_tokens = 30;  ///< behind the prefix
    bool together = false;    ///< one caption for all the pictures, views of the same thing
};

struct Caption {
    std::string text;   ///< one line, the prefix included
    bool ended = true;  ///< false: cut off at max_new_tokens
};

class Captioner {
  public:
    virtual ~Captioner() = default;
    /// One for each picture (or one in all, if together), bytes [H, W, C] as ImageProcessor takes
    /// them, all in one pass. Throws InputError for a prefix that is too long, Interrupted after
    /// Ctrl-C.
    virtual std::vector<Caption> captions(const std::vector<at::Tensor>& pictures,
                                          const CaptionOptions& options) const = 0;
    std::string caption(const at::Tensor& picture, const CaptionOptions& options) const {
        return captions({picture}, options).front().text;
    }
    /// What all the pictures, views of the same thing, are best described by: a word that one view
    /// leaves open is decided by the others.
    std::string caption_together(const std::vector<at::Tensor>& pictures,
                                 CaptionOptions options) const {
        options.together = true;
        return captions(pictures, options).front().text;
    }
};

/// Reads a folder of transformers' BlipForConditionalGeneration or Blip2ForConditionalGeneration
/// (with OPT): config.json, model.*, preprocessor_config.json and the tokenizer's files. Throws
/// InputError naming the file for anything missing or unsupported.
std::unique_ptr<Captioner> load_captioner(const std::filesystem::path& folder,
                                          at::Device device = at::kCPU,
                                          at::ScalarType dtype = at::kFloat);

}  // namespace item3d
