// Image captioning by BLIP or BLIP-2.
#pragma once

#include "item3d/tensors/tensor.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// Number of beams for a single caption. With three, the search finds a likelier caption than
/// greedy search does.
inline constexpr int caption_beams = 3;

struct CaptionOptions {
    std::string prefix;       ///< beginning of the caption, for example "a photo of"
    int beams = 1;            ///< 1 for greedy search
    int max_new_tokens = 30;  ///< tokens after the prefix
    /// True for one caption of all images, which are then views of one object.
    bool together = false;
};

struct Caption {
    std::string text;   ///< one line, including the prefix
    bool ended = true;  ///< false if truncated at max_new_tokens
};

class Captioner {
  public:
    virtual ~Captioner() = default;
    /// Captions all images in one pass, one caption each (or one for all, if options.together).
    /// Each image is bytes [H, W, C] as for ImageProcessor. Throws InputError for a prefix that is
    /// too long, and Interrupted after Ctrl-C.
    virtual std::vector<Caption> captions(const std::vector<at::Tensor>& images,
                                          const CaptionOptions& options) const = 0;
    std::string caption(const at::Tensor& image, const CaptionOptions& options) const {
        return captions({image}, options).front().text;
    }
    /// Returns one caption for several views of the same object: the one that fits all views best.
    /// If one view leaves a word open, the other views decide it.
    std::string caption_together(const std::vector<at::Tensor>& images,
                                 CaptionOptions options) const {
        options.together = true;
        return captions(images, options).front().text;
    }
};

/// Reads a folder of transformers' BlipForConditionalGeneration or Blip2ForConditionalGeneration
/// (with OPT): config.json, model.*, preprocessor_config.json and the tokenizer's files. Throws
/// InputError that names the file for a part that is missing or unsupported.
std::unique_ptr<Captioner> load_captioner(const std::filesystem::path& folder,
                                          at::Device device = at::kCPU,
                                          at::ScalarType dtype = at::kFloat);

}  // namespace item3d
