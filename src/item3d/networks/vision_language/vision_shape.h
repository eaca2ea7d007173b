// Dimensions of the vision transformers (Dosovitskiy et al. 2021) of CLIP and BLIP.
#pragma once

#include "item3d/core/config.h"

namespace item3d {

struct VisionShape {
    int hidden_size = 768;
    int intermediate_size = 3072;
    int num_hidden_layers = 12;
    int num_attention_heads = 12;
    int image_size = 224;  ///< pixels along one side
    int patch_size = 32;
    double layer_norm_eps = 1e-5;

    bool operator==(const VisionShape&) const = default;
    /// Reads a config; missing keys leave values unchanged. Throws InputError.
    void read(const Config& config);
    nlohmann::json to_json() const;
    int tokens() const;  ///< number of patches plus the class token
    double min_parameters() const;
};

}  // namespace item3d
