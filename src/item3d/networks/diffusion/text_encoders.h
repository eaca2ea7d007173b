// Tokenizers and text encoders of a pipeline: one of each, or two for SDXL.
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
    /// SDXL's second tokenizer; its encoder is model_2.
    std::shared_ptr<ClipTokenizer> tokenizer_2;
    ClipTextModel model_2{nullptr};

    /// Reads the sub-folders tokenizer and text_encoder, in float32; with_second: also tokenizer_2
    /// and text_encoder_2. Throws InputError that names the file for a part that is missing, of the
    /// wrong shape, unsupported, or of another model.
    static TextEncoders load(const std::filesystem::path& folder, bool with_second,
                             at::Device device = at::kCPU);

    bool is_sdxl() const { return !model_2.is_empty(); }

    /// Encodes prompts, padded and truncated, to one float32 embedding each: the last hidden
    /// states. For SDXL these are the penultimate hidden states of both encoders, concatenated, and
    /// the second encoder's projected pooled state.
    TextEmbedding encode(const std::vector<std::string>& prompts) const;

    /// Releases the weights; the models' configs stay.
    void release_weights();
};

}  // namespace item3d
