// The tokenizers and text encoders of a pipeline: one of each, or two for SDXL.
#pragma once

#include "item3d/networks/diffusion/text_embedding.h"
#include "item3d/networks/vision_language/clip_text.h"
#include "item3d/text/clip_tokenizer.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

struct TextEncoders {
    std::shared_ptr<ClipTokenizer> tokenizer;
    ClipTextModel model{nullptr};
    std::shared_ptr<ClipTokenizer> tokenizer_2;  ///< of SDXL, as is the model
    ClipTextModel model_2{nullptr};

    /// Reads the sub-folders tokenizer and text_encoder, with_second: tokenizer_2 and
    /// text_encoder_2 too; float32. Throws InputError naming the file for anything missing, of the
    /// wrong shape, unsupported, or of another model.
    static TextEncoders load(const std::filesystem::path& folder, bool with_second,
                             at::Device device = at::kCPU);

    bool is_sdxl() const { return !model_2.is_empty(); }

    /// A row for each prompt, padded and truncated: the last hidden states; for SDXL the last but
    /// one of both encoders side by side, and the second encoder's projected pooled state. float32.
    TextEmbedding encode(const std::vector<std::string>& prompts) const;

    /// Releases the weights; the models' configs stay.
    void release_weights();
};

}  // namespace item3d
