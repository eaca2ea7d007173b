// The application of edits' layers to a model, from files to a file.
#pragma once

#include "item3d/io/texture_format.h"
#include "item3d/layers/layer.h"
#include "item3d/layers/layer_use.h"
#include "item3d/provenance/signing.h"
#include "item3d/scene/model.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace item3d {

struct LayeredModelRequest {
    std::filesystem::path model;
    std::vector<LayerUse> layers;
    std::filesystem::path output;                        ///< .glb, .vrm, .gltf or .obj
    std::vector<std::filesystem::path> texture_folders;  ///< see LoadOptions
    /// Format of written textures. Without a value, the format of the layers' edits is used if they
    /// agree.
    std::optional<TextureFormat> texture_format;
    int texture_size = 0;  ///< longest edge of changed textures; 0 keeps their size
    std::shared_ptr<const SigningKey> sign_key = nullptr;  ///< null for an unsigned result
    /// Rebakes a layer for a model from the layer's field, with textures of this size (0 for the
    /// size in the layer's edit). If null, layers that do not fit are refused.
    std::function<EditLayer(const EditLayer&, const Model&, int texture_size)> rebake = nullptr;
};

/// Writes the model. If the file format stays, two results are exact bit for bit: a single layer at
/// full strength gives its edit's model.glb, and strengths of 0 give the model's file. `rebake`
/// rebakes all layers, with a note of the reason, if a texture size is given or a layer's images do
/// not fit the model (other sizes, another UV map). Warns if a layer fits but belongs to another
/// file. Returns "model", "output", "layers" (each with "file", "strength", "from", "to", and
/// "baked_because" if rebaked) and "materials" (the names of the changed materials). Throws
/// InputError as load_model(), load_layer(), rebake and apply_layers() do.
nlohmann::json write_layered_model(const LayeredModelRequest& request);

}  // namespace item3d
