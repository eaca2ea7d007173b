// A model with layers of edits on it, from files to a file.
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
    /// Of the textures that are written; none: as the layers' edits wrote them, where they agree.
    std::optional<TextureFormat> texture_format;
    int texture_size = 0;  ///< longest edge of the textures that layers change; 0: as they are
    std::shared_ptr<const SigningKey> sign_key = nullptr;  ///< null: the result is not signed
    /// Makes a layer anew for a model, from its field, with textures of this size (0: as its
    /// edit's). Null: layers that do not fit are refused.
    std::function<EditLayer(const EditLayer&, const Model&, int texture_size)> rebake = nullptr;
};

/// Writes the model; with a layer alone at full strength it has the bytes of its edit's model.glb,
/// with strengths of 0 those of the model's file, where the kind of file stays. Where a texture
/// size is asked for, and where a layer's pictures do not fit the model (other sizes, another UV
/// map), all layers are made anew by `rebake`, with a note that says why. A layer of another file
/// that fits is a warning. Returns "model", "output", "layers" (each with "file", "strength",
/// "from", "to", and "baked_because" where it was made anew) and "materials", those that changed,
/// by name. Throws InputError as load_model, load_layer, rebake and apply_layers do.
nlohmann::json write_layered_model(const LayeredModelRequest& request);

}  // namespace item3d
