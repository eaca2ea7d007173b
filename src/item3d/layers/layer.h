// An edit's changes, separate from its model: layer.safetensors (docs/formats.md).
#pragma once

#include "item3d/field/bake/bake.h"
#include "item3d/io/save.h"
#include "item3d/provenance/claim.h"
#include "item3d/tensors/safetensors.h"

#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace item3d {

enum class LayerSlot { base_color, metallic_roughness, normal };
inline constexpr std::array layer_slots = {LayerSlot::base_color, LayerSlot::metallic_roughness,
                                           LayerSlot::normal};

using LayerSize = std::pair<int, int>;  ///< width, height

/// One image of an edit. Values are integers, as in files, in units of 1 / (2^bits - 1).
struct LayerImage {
    LayerSlot slot = LayerSlot::base_color;
    int width = 0, height = 0, channels = 0;
    int bits = 8;  ///< for each channel: 8 or 16
    /// Left edge, top edge and first channel of `change` in the image.
    int x = 0, y = 0, channel = 0;
    /// Edited minus previous image, [h, w, c], restricted to the rectangle and the channels that
    /// changed: int8, int16 or int32, the narrowest type that holds the values. Undefined if
    /// nothing changed.
    at::Tensor change;
    /// Previous image, [height, width, channels] uint8 or int32, if it does not follow from the
    /// model (source_image.h); else undefined.
    at::Tensor source;
    /// Weight of the edit at each texel, [height, width] uint8, where 255 is full weight. Defined
    /// only for the first image of a material with a region.
    at::Tensor mask;
    /// Size of the model's texture in this slot; for metallic_roughness also the size of its
    /// occlusion texture.
    std::optional<LayerSize> source_size, occlusion_size;
};

/// State of a material when the edit began, if it differs from the file: emission that became base
/// colour, transparency that was removed.
struct MaterialBeginning {
    int base_color_texture = -1;
    Vec4 base_color_factor{1.0f};
    float metallic_factor = 1.0f;
};

struct LayerMaterial {
    std::string name;
    /// Indices into EditLayer::images, by slot; -1 if the slot is unchanged.
    std::array<int, 3> images{-1, -1, -1};
    MaterialEdit changes;  ///< flags of the edit; its images are empty
    std::optional<MaterialBeginning> beginning;
    /// uv_moments() of the model; no value in older files.
    std::optional<std::vector<double>> uvs;
};

/// The region of an edit, as in RegionRequest (region/region.h).
struct LayerRegion {
    std::vector<std::string> include, exclude;
    float feather = 0;
};

struct EditLayer {
    std::filesystem::path path;  ///< file that the layer was read from
    std::string model;           ///< file name of the model
    std::string model_hash;      ///< hash_of_file() of the model
    nlohmann::json settings;     ///< "from", "to" and all others, as in edit.json
    EditClaim claim;             ///< claim of the edit; empty if claims are disabled
    std::vector<LayerImage> images;
    std::map<int, LayerMaterial> materials;   ///< by index into Model::materials
    std::map<int, PrimitiveEdit> primitives;  ///< by index into Model::primitives
    std::map<int, int> primitive_materials;   ///< material of each primitive
    std::optional<BakedChannels> channels;    ///< channels baked from the field, if known
    std::optional<LayerRegion> region;        ///< no value for the whole surface
    nlohmann::json field;                     ///< options of the neural textures
    NamedTensors parameters;                  ///< parameters of the neural textures (layer_field.h)
};

/// Writes the file atomically. Throws ResourceError on a full disk.
void save_layer(const std::filesystem::path& path, const EditLayer& layer);

/// Loads a layer; tensors share the file's memory map. Throws InputError for a file that is not a
/// layer, or whose parts are inconsistent.
EditLayer load_layer(const std::filesystem::path& path);

}  // namespace item3d
