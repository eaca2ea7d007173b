#include "item3d/io/gltf/patch_material.h"

#include "item3d/io/gltf/materials.h"
#include "item3d/io/texture_format.h"

#include <algorithm>

namespace item3d {
namespace {

constexpr const char* transform_name = "KHR_texture_transform";

bool is_texture_info(const std::string& key, const Json& value) {
    return value.is_object() && value.contains("index") && key.size() >= 7 &&
           (key.ends_with("Texture") || key.ends_with("texture"));
}

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

// Not 1 throughout.
bool has_occlusion(const Image& image) {
    for (std::size_t i = 0; i < image.pixels.size();
         i += static_cast<std::size_t>(image.channels)) {
        if (image.pixels[i] < 1.0f - 0.5f / 255.0f) return true;
    }
    return false;
}

/// Points texture infos at new textures, keeping what else they hold.
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

void drop_extension(Json& object, const char* name) {
    const auto extensions = object.find("extensions");
    if (extensions == object.end()) return;
    extensions->erase(name);
    if (extensions->empty()) object.erase("extensions");
}

}  // namespace

void move_texture_coordinates(Json& material, std::size_t set) {
    for (auto& [key, value] : material.items()) {
        if (!value.is_object()) continue;
        if (is_texture_info(key, value)) {
            if (value.value("texCoord", std::size_t{0}) == 0) value["texCoord"] = set;
            const auto extensions = value.find("extensions");
            if (extensions == value.end() || !extensions->contains(transform_name)) continue;
            Json& transform = (*extensions)[transform_name];
            if (transform.contains("texCoord") && transform["texCoord"] == 0)
                transform["texCoord"] = set;
        } else {
            move_texture_coordinates(value, set);
        }
    }
}

void patch_material(const SourceDocument& document, const Json& original, const MaterialEdit& edit,
                    const UvPlan& plan, const std::string& name, Json& material,
                    GltfBuilder& builder) {
    const UvLayout layout = material_uv_layout(GltfObject(document, original, "material"));
    InfoWriter infos(plan, layout, builder.json());
    const auto add_texture = [&](const Image& image, const ImageCoding& coding, const char* what,
                                 const Json* old_info) {
        return builder.add_texture(encode_texture(image, coding, edit.bits_per_channel),
                                   coding.encoding, name + "_" + what,
                                   sampler_of(document.json, old_info));
    };
    const Json* old_pbr = find(original, "pbrMetallicRoughness");
    if (edit.base_color || edit.metallic_roughness) {
        // Viewers that know this older model would prefer it to the edited values.
        if (!old_pbr && material.contains("extensions") &&
            material["extensions"].contains("KHR_materials_pbrSpecularGlossiness")) {
            const Json old = material["extensions"]["KHR_materials_pbrSpecularGlossiness"];
            Json& pbr = material["pbrMetallicRoughness"] = Json::object();
            if (old.contains("diffuseFactor")) pbr["baseColorFactor"] = old["diffuseFactor"];
            if (old.contains("diffuseTexture")) pbr["baseColorTexture"] = old["diffuseTexture"];
            pbr["metallicFactor"] = 0.0;
            pbr["roughnessFactor"] = 1.0 - old.value("glossinessFactor", 1.0);
        }
        drop_extension(material, "KHR_materials_pbrSpecularGlossiness");
        // What was edited is a surface in light.
        drop_extension(material, "KHR_materials_unlit");
        if (!material.contains("pbrMetallicRoughness")) {
            material["pbrMetallicRoughness"] = Json::object();
        }
    }
    if (edit.base_color) {
        Json& pbr = material["pbrMetallicRoughness"];
        infos.write(pbr, "baseColorTexture",
                    add_texture(*edit.base_color, edit.base_color_coding, "base_color",
                                old_pbr ? find(*old_pbr, "baseColorTexture") : nullptr));
        double alpha = 1.0;
        if (edit.base_color->channels != 4 && pbr.contains("baseColorFactor")) {
            alpha = pbr["baseColorFactor"][3].get<double>();
        }
        pbr["baseColorFactor"] = Json::array({1.0, 1.0, 1.0, alpha});
    }
    if (edit.metallic_roughness) {
        Json& pbr = material["pbrMetallicRoughness"];
        const Json* old_info = old_pbr ? find(*old_pbr, "metallicRoughnessTexture") : nullptr;
        const std::size_t texture =
            add_texture(*edit.metallic_roughness, edit.metallic_roughness_coding, "orm", old_info);
        infos.write(pbr, "metallicRoughnessTexture", texture);
        pbr["metallicFactor"] = 1.0;
        pbr["roughnessFactor"] = 1.0;
        // Occlusion that looks at other coordinates was not loaded, so it is not in the image.
        const Json* old_occlusion = find(original, "occlusionTexture");
        const bool was_loaded =
            old_occlusion &&
            read_uv_layout(GltfObject(document, *old_occlusion, "occlusionTexture")) == layout;
        if (was_loaded || (!old_occlusion && has_occlusion(*edit.metallic_roughness))) {
            infos.write(material, "occlusionTexture", texture);
            material["occlusionTexture"].erase("strength");
        }
    }
    if (edit.normal) {
        infos.write(material, "normalTexture",
                    add_texture(*edit.normal, edit.normal_coding, "normal",
                                find(original, "normalTexture")));
        material["normalTexture"].erase("scale");
    }
}

}  // namespace item3d
