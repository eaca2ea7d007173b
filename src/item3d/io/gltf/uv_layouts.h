// The texture coordinates that a glTF material's textures use. Internal to io.
#pragma once

#include "item3d/core/math.h"
#include "item3d/io/gltf/document.h"

#include <optional>
#include <vector>

namespace item3d {

/// A UV map with its transform for a texture (KHR_texture_transform): uv = offset +
/// rotate(rotation) * (scale * TEXCOORD_n).
struct UvLayout {
    std::size_t tex_coord = 0;
    Vec2 offset{0.0f};
    float rotation = 0.0f;
    Vec2 scale{1.0f};

    bool operator==(const UvLayout&) const = default;
    bool is_transformed() const;
    Vec2 apply(Vec2 uv) const;
};

UvLayout read_uv_layout(const GltfObject& texture_info);

/// Texture infos of a material by purpose. If the material has only
/// KHR_materials_pbrSpecularGlossiness, the diffuse texture counts as base colour and the
/// specular-glossiness texture as metallic-roughness.
struct TextureSlots {
    std::optional<GltfObject> base_color, metallic_roughness, normal, occlusion, emissive;

    explicit TextureSlots(const GltfObject& material);
};

/// True if pbrMetallicRoughness is not empty. Some exporters write an empty object beside
/// KHR_materials_pbrSpecularGlossiness.
bool has_metallic_roughness(const GltfObject& material);

/// Returns an extension of an object, if present.
std::optional<GltfObject> find_extension(const GltfObject& object, const char* name);

/// Returns the distinct layouts of a material's textures, in the order base colour,
/// metallic-roughness, normal, occlusion, emissive; at least one. The first layout applies to
/// Primitive::uvs, the others to Primitive::further_uvs.
std::vector<UvLayout> material_uv_layouts(const GltfObject& material);

/// Returns the first layout, which edited textures use.
UvLayout material_uv_layout(const GltfObject& material);

}  // namespace item3d
