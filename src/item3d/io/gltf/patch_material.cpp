#include "item3d/io/gltf/patch_material.h"

#include "item3d/core/progress.h"
#include "item3d/io/gltf/uv_layouts.h"
#include "item3d/io/texture_format.h"

#include <algorithm>

namespace item3d {
namespace {

int sampler_of(const Json& json, const Json* info) {
    if (!info || !info->is_object() || !info->contains("index")) return -1;
    const Json& texture = json["textures"][(*info)["index"].get<std::size_t>()];
    const auto sampler = texture.find("sampler");
    return sampler == texture.end() ? -1 : sampler->get<int>();
}

const Json* find(const Json& object, const char* key) {
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
}

// True if any value of the occlusion channel differs from 1.
bool has_occlusion(const Image& image) {
    for (std::size_t i = 0; i < image.pixels.size();
         i += static_cast<std::size_t>(image.channels)) {
        if (image.pixels[i] < 1.0f - 0.5f / 255.0f) return true;
    }
    return false;
}

/// Sets the texture of texture infos and keeps their other properties.
class InfoWriter {
  public:
    InfoWriter(const UvPlan& plan, const UvLayout& layout, Json& json)
        : plan_(plan), layout_(layout), json_(json) {}

    void write(Json& owner, const char* key, std::size_t texture) {
        Json& info = owner[key];
        if (!info.is_object()) info = Json::object();
        info["index"] = texture;
        const std::size_t set = plan_.has_new_uvs ? plan_.new_set : layout_.tex_coord;
        if (set != 0) {
            info["texCoord"] = set;
        } else {
            info.erase("texCoord");
        }
        if (!plan_.has_new_uvs && layout_.is_transformed()) {
            write_transform(info);
        } else if (info.contains("extensions")) {
            info["extensions"].erase(transform_name);
            if (info["extensions"].empty()) info.erase("extensions");
        }
    }

  private:
    void write_transform(Json& info) {
        Json& transform = info["extensions"][transform_name];
        const Json extras =
            transform.is_object() && transform.contains("extras") ? transform["extras"] : Json();
        transform = Json::object();
        if (layout_.offset != Vec2(0.0f)) {
            transform["offset"] = Json::array({layout_.offset.x, layout_.offset.y});
        }
        if (layout_.rotation != 0.0f) transform["rotation"] = layout_.rotation;
        if (layout_.scale != Vec2(1.0f)) {
            transform["scale"] = Json::array({layout_.scale.x, layout_.scale.y});
        }
        if (!extras.is_null()) transform["extras"] = extras;
        Json& used = json_["extensionsUsed"];
        if (!used.is_array()) used = Json::array();
        if (std::find(used.begin(), used.end(), transform_name) == used.end()) {
            used.push_back(transform_name);
        }
    }

    const UvPlan& plan_;
    const UvLayout& layout_;
    Json& json_;
};

std::optional<std::size_t> texture_of(const Json* info) {
    if (!info || !info->is_object() || !info->contains("index")) return std::nullopt;
    return (*info)["index"].get<std::size_t>();
}

void drop_extension(Json& object, const char* name) {
    const auto extensions = object.find("extensions");
    if (extensions == object.end()) return;
    extensions->erase(name);
    if (extensions->empty()) object.erase("extensions");
}

void drop_emission(Json& material) {
    material.erase("emissiveTexture");
    material.erase("emissiveFactor");
    drop_extension(material, "KHR_materials_emissive_strength");
}

/// Updates the texture infos of a material's extensions and of its emission, if they show the
/// replaced image with the same UV layout.
class Follower {
  public:
    Follower(const SourceDocument& document, const UvLayout& layout,
             const std::vector<ReplacedTexture>& replaced, InfoWriter& infos)
        : document_(document), layout_(layout), replaced_(replaced), infos_(infos) {}

    void follow(const Json& original, Json& material) {
        if (const auto found = original.find("extensions");
            found != original.end() && material.contains("extensions"))
            follow_within(*found, material["extensions"], 0);
        if (const auto found = original.find("emissiveTexture"); found != original.end())
            follow_info("emissiveTexture", *found, material);
    }

  private:
    void follow_within(const Json& original, Json& value, int depth) {
        if (!original.is_object() || !value.is_object() || depth > 8) return;
        for (const auto& [key, child] : original.items()) {
            if (!value.contains(key)) continue;
            if (is_texture_info(key, child))
                follow_info(key, child, value);
            else
                follow_within(child, value[key], depth + 1);
        }
    }

    void follow_info(const std::string& key, const Json& info, Json& owner) {
        if (!owner.contains(key) || !texture_of(&info)) return;
        const ReplacedTexture* found = find_replaced(document_, replaced_, *texture_of(&info));
        if (!found) return;
        if (read_uv_layout(GltfObject(document_, info, key)) == layout_) {
            infos_.write(owner, key.c_str(), found->new_texture);
        } else {
            warn(document_.path.string() + ": a material's " + key +
                 " uses the old image with other texture coordinates and was not edited");
        }
    }

    const SourceDocument& document_;
    const UvLayout& layout_;
    const std::vector<ReplacedTexture>& replaced_;
    InfoWriter& infos_;
};

}  // namespace

std::vector<ReplacedTexture> patch_material(const SourceDocument& document, const Json& original,
                                            const MaterialEdit& edit, const UvPlan& plan,
                                            const std::string& name, Json& material,
                                            GltfBuilder& builder) {
    std::vector<ReplacedTexture> replaced;
    const UvLayout layout = material_uv_layout(GltfObject(document, original, "material"));
    InfoWriter infos(plan, layout, builder.json());
    const auto add_texture = [&](const EditedTexture& texture, const char* what,
                                 const Json* old_info) {
        return builder.add_texture(texture, name + "_" + what, sampler_of(document.json, old_info));
    };
    const Json* old_pbr = find(original, "pbrMetallicRoughness");
    if (edit.base_color || edit.metallic_roughness) {
        // KHR_materials_pbrSpecularGlossiness is replaced, since viewers that support it would
        // prefer it to the edited values.
        const bool is_older = !has_metallic_roughness(GltfObject(document, original, "material"));
        if (is_older && material.contains("extensions") &&
            material["extensions"].contains("KHR_materials_pbrSpecularGlossiness")) {
            const Json old = material["extensions"]["KHR_materials_pbrSpecularGlossiness"];
            Json& pbr = material["pbrMetallicRoughness"] = Json::object();
            if (old.contains("diffuseFactor")) pbr["baseColorFactor"] = old["diffuseFactor"];
            if (old.contains("diffuseTexture")) pbr["baseColorTexture"] = old["diffuseTexture"];
            pbr["metallicFactor"] = 0.0;
            pbr["roughnessFactor"] = 1.0 - old.value("glossinessFactor", 1.0);
            const bool has_specular =
                old.contains("specularFactor") || old.contains("specularGlossinessTexture");
            if (has_specular && !(edit.base_color && edit.metallic_roughness)) {
                warn(document.path.string() + ": material '" + name +
                     "' was converted to metallic-roughness; its unedited parts are treated as "
                     "non-metal");
            }
        }
        drop_extension(material, "KHR_materials_pbrSpecularGlossiness");
        // Edited materials are lit, so KHR_materials_unlit is removed. Unlit materials do not show
        // emission, so emission is removed too.
        const Json* extensions = find(original, "extensions");
        if (extensions && extensions->contains("KHR_materials_unlit")) drop_emission(material);
        drop_extension(material, "KHR_materials_unlit");
        if (!material.contains("pbrMetallicRoughness")) {
            material["pbrMetallicRoughness"] = Json::object();
        }
    }
    if (edit.base_color) {
        Json& pbr = material["pbrMetallicRoughness"];
        const Json* old_info = old_pbr ? find(*old_pbr, "baseColorTexture") : nullptr;
        const std::size_t texture = add_texture(edit.base_color, "base_color", old_info);
        infos.write(pbr, "baseColorTexture", texture);
        if (const auto old = texture_of(old_info)) replaced.push_back({*old, texture, true});
        double alpha = 1.0;
        if (edit.base_color->channels != 4 && pbr.contains("baseColorFactor")) {
            alpha = pbr["baseColorFactor"][3].get<double>();
        }
        pbr["baseColorFactor"] = Json::array({1.0, 1.0, 1.0, alpha});
    }
    if (edit.metallic_roughness) {
        Json& pbr = material["pbrMetallicRoughness"];
        const Json* old_info = old_pbr ? find(*old_pbr, "metallicRoughnessTexture") : nullptr;
        const std::size_t texture = add_texture(edit.metallic_roughness, "orm", old_info);
        infos.write(pbr, "metallicRoughnessTexture", texture);
        pbr["metallicFactor"] = 1.0;
        pbr["roughnessFactor"] = 1.0;
        const Json* old_occlusion = find(original, "occlusionTexture");
        if (!edit.keeps_occlusion && (old_occlusion || has_occlusion(*edit.metallic_roughness))) {
            infos.write(material, "occlusionTexture", texture);
            material["occlusionTexture"].erase("strength");
        }
    }
    if (edit.normal) {
        const Json* old_info = find(original, "normalTexture");
        const std::size_t texture = add_texture(edit.normal, "normal", old_info);
        infos.write(material, "normalTexture", texture);
        material["normalTexture"].erase("scale");
        if (const auto old = texture_of(old_info)) replaced.push_back({*old, texture});
    }
    if (edit.removes_emission) drop_emission(material);
    if (edit.makes_opaque) {
        material.erase("alphaMode");
        material.erase("alphaCutoff");
        if (material.contains("pbrMetallicRoughness") &&
            material["pbrMetallicRoughness"].contains("baseColorFactor"))
            material["pbrMetallicRoughness"]["baseColorFactor"][3] = 1.0;
    }
    for (const std::string& extension : edit.removed_extensions)
        drop_extension(material, extension.c_str());
    Follower(document, layout, replaced, infos).follow(original, material);
    return replaced;
}

}  // namespace item3d
