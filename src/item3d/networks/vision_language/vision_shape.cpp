#include "item3d/networks/vision_language/vision_shape.h"

namespace item3d {

void VisionShape::read(const Config& config) {
    hidden_size = config.size("hidden_size", hidden_size);
    intermediate_size = config.size("intermediate_size", intermediate_size);
    num_hidden_layers = config.size("num_hidden_layers", num_hidden_layers);
    num_attention_heads = config.size("num_attention_heads", num_attention_heads);
    image_size = config.size("image_size", image_size);
    patch_size = config.size("patch_size", patch_size);
    layer_norm_eps = config.number("layer_norm_eps", layer_norm_eps);
    if (hidden_size % num_attention_heads != 0)
        config.fail("num_attention_heads", "a divisor of hidden_size");
    if (num_hidden_layers > 256) config.fail("num_hidden_layers", "at most 256");
    if (image_size > 4096) config.fail("image_size", "at most 4096");
    if (patch_size > image_size) config.fail("patch_size", "at most image_size");
}

nlohmann::json VisionShape::to_json() const {
    return {
        {"attention_dropout", 0.0},
        {"hidden_size", hidden_size},
        {"image_size", image_size},
        {"intermediate_size", intermediate_size},
        {"layer_norm_eps", layer_norm_eps},
        {"num_attention_heads", num_attention_heads},
        {"num_hidden_layers", num_hidden_layers},
        {"patch_size", patch_size},
    };
}

int VisionShape::tokens() const {
    const int side = image_size / patch_size;
    return side * side + 1;
}

double VisionShape::min_parameters() const {
    const double width = hidden_size;
    return width * (tokens() + 3.0 * patch_size * patch_size) +
           num_hidden_layers * (4 * width * width + 2 * width * intermediate_size);
}

}  // namespace item3d
