#include "item3d/networks/diffusion/textual_inversion.h"

#include "item3d/core/error.h"
#include "item3d/core/format.h"
#include "item3d/networks/diffusion/adapter_file.h"

namespace item3d {
namespace {

/// The name of each encoder's tensor, and the token that the file names.
struct Layout {
    std::vector<std::string> tensors;
    std::string token;
};

Layout layout_of(const SafeTensors& file, std::size_t encoders) {
    const std::string stem = file.path().stem().string();
    const bool is_pair = file.contains("clip_l") && file.contains("clip_g");
    if (is_pair != (encoders == 2))
        throw InputError(file.path().string(),
                         is_pair ? "has vectors for two text encoders (SDXL), this model has one"
                                 : "has vectors for one text encoder, this model has two (SDXL), "
                                   "which need 'clip_l' and 'clip_g'",
                         "use an embedding that was made for this model");
    if (is_pair) return {{"clip_l", "clip_g"}, stem};
    if (file.contains("emb_params")) return {{"emb_params"}, stem};
    if (file.names().size() == 1) return {{file.names()[0]}, file.names()[0]};
    throw InputError(
        file.path().string(),
        fmt::format("has {} tensors, expected one with the name of its token, or 'emb_params'",
                    file.names().size()),
        "use a textual inversion; use --lora for a LoRA");
}

/// Reads vectors [count, D], checked against the encoder.
at::Tensor read_vectors(const SafeTensors& file, const std::string& name,
                        const TextEncoderPair& encoder) {
    at::Tensor vectors = file.tensor(name);
    const auto reject = [&](const std::string& problem) {
        throw InputError(file.path().string(), fmt::format("tensor '{}' {}", name, problem),
                         "use an embedding that was made for this model");
    };
    if (!vectors.is_floating_point()) reject("is not a floating-point tensor");
    const int width = encoder.text_encoder->config().hidden_size;
    if (vectors.dim() == 1) vectors = vectors.unsqueeze(0);
    if (vectors.dim() != 2 || vectors.size(1) != width)
        reject(fmt::format("has shape [{}], expected vectors of {} numbers",
                           fmt::join(file.tensor(name).sizes().vec(), ", "), width));
    const int room = encoder.tokenizer->model_max_length() - 2;  // without start and end token
    if (vectors.size(0) < 1 || vectors.size(0) > room)
        reject(fmt::format("has {} vectors, but a prompt takes 1 to {}", vectors.size(0), room));
    return vectors;
}

}  // namespace

std::string add_embedding(const std::filesystem::path& file, const std::string& token,
                          const std::vector<TextEncoderPair>& encoders) {
    ITEM3D_CHECK(encoders.size() == 1 || encoders.size() == 2, "one or two text encoders");
    const SafeTensors tensors = open_adapter(file);
    const Layout layout = layout_of(tensors, encoders.size());
    const std::string name = token.empty() ? layout.token : token;
    std::vector<at::Tensor> vectors;
    for (std::size_t i = 0; i < encoders.size(); ++i)
        vectors.push_back(read_vectors(tensors, layout.tensors[i], encoders[i]));
    if (vectors.front().size(0) != vectors.back().size(0))
        throw InputError(file.string(),
                         fmt::format("'clip_l' has {} vectors and 'clip_g' {}",
                                     vectors.front().size(0), vectors.back().size(0)),
                         "both need the same number; choose another embedding");
    for (std::size_t i = 0; i < encoders.size(); ++i) {
        ClipTextModel text_encoder = encoders[i].text_encoder;
        const int first = encoders[i].tokenizer->add_placeholder(
            name, static_cast<int>(vectors[i].size(0)), file.string());
        text_encoder->set_token_embeddings(first, vectors[i]);
    }
    return name;
}

}  // namespace item3d
