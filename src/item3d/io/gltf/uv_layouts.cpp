#include "item3d/io/gltf/uv_layouts.h"

#include <algorithm>
#include <cmath>

namespace item3d {
namespace {

std::optional<GltfObject> child(const std::optional<GltfObject>& object, const char* name) {
    return object ? object->object(name) : std::nullopt;
}

}  // namespace

bool UvLayout::is_transformed() const {
    return offset != Vec2(0.0f) || rotation != 0.0f || scale != Vec2(1.0f);
}

Vec2 UvLayout::apply(Vec2 uv) const {
    const Vec2 scaled = uv * scale;
    const float c = std::cos(rotation);
    const float s = std::sin(rotation);
    return offset + Vec2(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x);
}

UvLayout read_uv_layout(const GltfObject& info) {
    UvLayout layout;
    layout.tex_coord = info.integer("texCoord", 0);
    if (const auto transform = find_extension(info, "KHR_texture_transform")) {
        if (const auto v = transform->numbers("offset", 2); !v.empty())
            layout.offset = Vec2(v[0], v[1]);
        if (const auto v = transform->numbers("scale", 2); !v.empty())
            layout.scale = Vec2(v[0], v[1]);
        layout.rotation = static_cast<float>(transform->number("rotation", 0.0));
        layout.tex_coord = transform->integer("texCoord", layout.tex_coord);
    }
    return layout;
}

TextureSlots::TextureSlots(const GltfObject& material)
    : base_color(child(material.object("pbrMetallicRoughness"), "baseColorTexture")),
      metallic_roughness(
          child(material.object("pbrMetallicRoughness"), "metallicRoughnessTexture")),
      normal(material.object("normalTexture")),
      occlusion(material.object("occlusionTexture")),
      emissive(material.object("emissiveTexture")) {
    if (!has_metallic_roughness(material)) {
        const auto old = find_extension(material, "KHR_materials_pbrSpecularGlossiness");
        base_color = child(old, "diffuseTexture");
        metallic_roughness = child(old, "specularGlossinessTexture");
    }
}

bool has_metallic_roughness(const GltfObject& material) {
    const auto pbr = material.object("pbrMetallicRoughness");
    if (!pbr) return false;
    for (const char* key : {"baseColorFactor", "baseColorTexture", "metallicFactor",
                            "roughnessFactor", "metallicRoughnessTexture"})
        if (pbr->has(key)) return true;
    return false;
}

std::optional<GltfObject> find_extension(const GltfObject& object, const char* name) {
    return child(object.object("extensions"), name);
}

std::vector<UvLayout> material_uv_layouts(const GltfObject& material) {
    const TextureSlots slots(material);
    std::vector<UvLayout> layouts;
    for (const auto* slot : {&slots.base_color, &slots.metallic_roughness, &slots.normal,
                             &slots.occlusion, &slots.emissive}) {
        if (!*slot) continue;
        const UvLayout layout = read_uv_layout(**slot);
        if (std::find(layouts.begin(), layouts.end(), layout) == layouts.end())
            layouts.push_back(layout);
    }
    if (layouts.empty()) layouts.emplace_back();
    return layouts;
}

UvLayout material_uv_layout(const GltfObject& material) {
    return material_uv_layouts(material).front();
}

}  // namespace item3d
