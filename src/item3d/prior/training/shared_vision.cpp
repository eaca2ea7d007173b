#include "item3d/prior/training/shared_vision.h"

#include <string>

namespace item3d {

bool copy_vision(const BlipModel& from, const ClipModel& to, const torch::Tensor& pixel_values) {
    const ClipVisionConfig config = to->config().vision;
    const VisionShape& shape = config;
    if (shape != from->config().vision || config.hidden_act != "gelu") return false;

    const torch::NoGradGuard no_grad;
    const std::string vision = "vision_model.";
    const auto theirs = from->named_parameters();
    auto ours = to->named_parameters();
    const auto their = [&](const std::string& name) { return theirs[vision + name]; };
    const auto set = [&](const std::string& name, const torch::Tensor& value) {
        torch::Tensor& target = ours[vision + name];
        target.copy_(value.reshape(target.sizes()));
    };
    const torch::Tensor patch = their("embeddings.patch_embedding.weight");
    torch::Tensor positions = their("embeddings.position_embedding")[0].clone();
    positions.slice(0, 1) += their("embeddings.patch_embedding.bias");
    set("embeddings.class_embedding", their("embeddings.class_embedding"));
    set("embeddings.patch_embedding.weight", patch);
    set("embeddings.position_embedding.weight", positions);
    const torch::Tensor states =
        torch::conv2d(pixel_values, patch, {}, config.patch_size).flatten(2).transpose(1, 2) +
        positions.slice(0, 1);
    ours[vision + "pre_layrnorm.weight"].fill_(states.std(-1).mean());

    for (const char* suffix : {".weight", ".bias"}) {
        set(std::string("post_layernorm") + suffix, their(std::string("post_layernorm") + suffix));
        for (int i = 0; i < config.num_hidden_layers; ++i) {
            const std::string layer = "encoder.layers." + std::to_string(i) + ".";
            const std::string attention = layer + "self_attn.";
            const auto qkv = their(attention + "qkv" + suffix).chunk(3, 0);
            set(attention + "q_proj" + suffix, qkv[0]);
            set(attention + "k_proj" + suffix, qkv[1]);
            set(attention + "v_proj" + suffix, qkv[2]);
            set(attention + "out_proj" + suffix, their(attention + "projection" + suffix));
            for (const char* same : {"layer_norm1", "layer_norm2", "mlp.fc1", "mlp.fc2"})
                set(layer + same + suffix, their(layer + same + suffix));
        }
    }
    return true;
}

}  // namespace item3d
