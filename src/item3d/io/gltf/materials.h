// Materials and textures of a glTF. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"
#include "item3d/scene/model.h"

#include <map>

namespace item3d {

/// Which texture coordinates a texture looks at, and how they are transformed before
/// (KHR_texture_transform): uv = offset + rotate(rotation) * (scale * TEXCOORD_n).
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

/// The layout of a material as a whole: that of its first texture in the order base colour,
/// metallic-roughness, normal, occlusion, emissive. Primitive::uvs are in it. Textures with another
/// layout are not loaded.
UvLayout material_uv_layout(const GltfObject& material);

/// The default of glTF, for primitives that name no material.
Material default_gltf_material();

/// Reads all factors of all materials into the model; textures only of those that are `used`.
/// Pictures that cannot be read are warnings.
void read_gltf_materials(const SourceDocument& document, const std::vector<bool>& used,
                         Model& model);

}  // namespace item3d
