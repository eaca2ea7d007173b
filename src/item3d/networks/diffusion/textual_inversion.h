// Textual inversion (Gal et al. 2022): learned vectors for a token of their own.
#pragma once

#include "item3d/networks/vision_language/clip_text.h"
#include "item3d/text/clip_tokenizer.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// A text encoder with the tokenizer that feeds it.
struct TextEncoderPair {
    std::shared_ptr<ClipTokenizer> tokenizer;
    ClipTextModel text_encoder{nullptr};
};

/// Teaches the encoders (one, or SDXL's two) the vectors of a .safetensors file. Layouts: one
/// tensor named after its token (diffusers), "emb_params" (AUTOMATIC1111), or "clip_l" and "clip_g"
/// (SDXL), [D] or [count, D]. The last two are called by `token`, else by the file's name without
/// its extension; a given token goes before diffusers' own. A prompt that has the token gets all of
/// its vectors. Returns the token. Throws InputError for a pickle, another layout, vectors of
/// another model's width, more vectors than a prompt holds, or a token that is there already.
std::string add_embedding(const std::filesystem::path& file, const std::string& token,
                          const std::vector<TextEncoderPair>& encoders);

}  // namespace item3d
