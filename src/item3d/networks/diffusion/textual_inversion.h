// Textual inversion (Gal et al. 2022): learned vectors of new tokens.
#pragma once

#include "item3d/networks/vision_language/clip_text.h"
#include "item3d/text/clip_tokenizer.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// A text encoder with its tokenizer.
struct TextEncoderPair {
    std::shared_ptr<ClipTokenizer> tokenizer;
    ClipTextModel text_encoder{nullptr};
};

/// Adds the vectors of a .safetensors file to the encoders (one, or SDXL's two). The file has one
/// of three layouts: a tensor named after its token (diffusers), a tensor "emb_params"
/// (AUTOMATIC1111), or tensors "clip_l" and "clip_g" (SDXL). Each tensor is [D] or [count, D]. The
/// token is `token`, or if that is empty, the tensor's name in a diffusers file and the file's name
/// without its extension in the other layouts. In a prompt the token stands for all of its vectors.
/// Returns the token. Throws InputError for a pickle, another layout, vectors of another model's
/// width, more vectors than a prompt holds, or a token that exists already.
std::string add_embedding(const std::filesystem::path& file, const std::string& token,
                          const std::vector<TextEncoderPair>& encoders);

}  // namespace item3d
