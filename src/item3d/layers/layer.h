// What an edit changed, apart from what it was applied to: layer.safetensors (docs/formats.md).
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

/// One picture of an edit. Values are the integers that a file has: steps of 1 / (2^bits - 1).
struct LayerPicture {
    LayerSlot slot = LayerSlot::base_color;
    int width = 0, height = 0, channels = 0;
    int bits = 8;  ///< a channel: 8 or 16
    /// Left, top and first channel of `change`.
    int x = 0, y = 0, channel = 0;
    /// The edited picture - the one before, [h, w, c] of the rectangle and the channels beyond
    /// which nothing changed: int8, int16 or int32, the narrowest that holds it. Undefined: no
    /// change.
    at::Tensor change;
    /// The picture before, [height, width, channels] uint8 or int32, where it does not follow from
    /// the model (source_picture.h). Undefined where it does.
    at::Tensor source;
    /// How much of the edit each texel takes, [height, width] uint8 of 255, of the first picture of
    /// materials of which a part was edited; else undefined.
    at::Tensor mask;
    /// Of the model's texture in that slot, and of its occlusion's beside metallic_roughness.
    std::optional<LayerSize> source_size, occlusion_size;
};

/// What a material was when the edit began, where that is not what its file says: emission that
/// became its base colour, transparency that went.
struct MaterialBeginning {
    int base_color_texture = -1;
    Vec4 base_color_factor{1.0f};
    float metallic_factor = 1.0f;
};

struct LayerMaterial {
    std::string name;
    /// Into EditLayer::pictures by slot, -1: the slot stays as it was.
    std::array<int, 3> pictures{-1, -1, -1};
    MaterialEdit changes;  ///< without pictures
    std::optional<MaterialBeginning> beginning;
    /// uv_moments() of the model; no value in files of before they were kept.
    std::optional<std::vector<double>> uvs;
};

/// The part of the surface that an edit was of, as RegionRequest has it (region/region.h).
struct LayerRegion {
    std::vector<std::string> include, exclude;
    float feather = 0;
};

struct EditLayer {
    std::filesystem::path path;  ///< it was read from
    std::string model;           ///< file name
    std::string model_hash;      ///< hash_of_file()
    nlohmann::json settings;     ///< "from", "to" and all others, as in edit.json
    EditClaim claim;             ///< of its edit; empty where that says nothing of itself
    std::vector<LayerPicture> pictures;
    std::map<int, LayerMaterial> materials;   ///< by index into Model::materials
    std::map<int, PrimitiveEdit> primitives;  ///< by index into Model::primitives
    std::map<int, int> primitive_materials;   ///< material of each of them
    std::optional<BakedChannels> channels;    ///< what was baked from the field; none: not kept
    std::optional<LayerRegion> region;        ///< none: the whole surface
    nlohmann::json field;                     ///< options of the neural textures
    NamedTensors parameters;                  ///< theirs (layer_field.h)
};

/// Writes the file atomically. Throws ResourceError on a full disk.
void save_layer(const std::filesystem::path& path, const EditLayer& layer);

/// Tensors share the file's memory map. Throws InputError for a file that is no layer, or whose
/// parts do not fit together.
EditLayer load_layer(const std::filesystem::path& path);

}  // namespace item3d
