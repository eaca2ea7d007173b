// A model with layers of edits on it, from files to a file.
#pragma once

#include "item3d/io/texture_format.h"
#include "item3d/layers/layer_use.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

struct LayeredModelRequest {
    std::filesystem::path model;
    std::vector<LayerUse> layers;
    std::filesystem::path output;                        ///< .glb, .vrm, .gltf or .obj
    std::vector<std::filesystem::path> texture_folders;  ///< see LoadOptions
    /// Of the textures that are written; none: as the layers' edits wrote them, where they agree.
    std::optional<TextureFormat> texture_format;
};

/// Writes the model; with a layer alone at full strength it has the bytes of its edit's model.glb,
/// with strengths of 0 those of the model's file, where the kind of file stays. A layer of another
/// file whose sizes fit is a warning. Returns "model", "output", "layers" (each with "file",
/// "strength", "from", "to") and "materials", those that changed, by name. Throws InputError as
/// load_model, load_layer and apply_layers do.
nlohmann::json write_layered_model(const LayeredModelRequest& request);

}  // namespace item3d
