// Textual inversion (Gal et al. 2022): learned vectors of new tokens.
#pragma once

#include "item3d/networks/vision_language/clip_text.h"
#include "item3d/text/clip_tokenizer.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// Text encoder with its tokenizer.
struct TextEncoderPair {
    std::shared_ptr<ClipTokenizer> tokenizer;
    ClipTextModel text_encoder{nullptr};
};

/// Adds the vectors of a .safetensors file to the encoders (one, or SDXL's two). Layouts: one
/// tensor named after its token (diffusers), "emb_params" (AUTOMATIC1111), or "clip_l" and "clip_g"
/// (SDXL), [D] or [count, D]. In the last two layouts, the token is `token`, else the file's name
/// without its extension. A given `token` also overrides that of a diffusers file. In a prompt the
/// token stands for all of its vectors. Returns the token. Throws InputError for a pickle, another
/// layout, vectors of another model's width, more vectors than a prompt holds, or a token that
/// exists already.
std::string add_embedding(const std::filesystem::path& file, const std::string& token,
                          const std::vector<TextEncoderPair>& encoders);

}  // namespace item3d
