#include "item3d/io/gltf/references.h"

#include "item3d/core/error.h"
#include "item3d/core/progress.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

namespace item3d {
namespace {

const Json* item_of(const Json& json, const char* list, std::size_t index) {
    const Json* items = find_path(json, {list});
    return items && items->is_array() && index < items->size() ? &(*items)[index] : nullptr;
}

std::string name_of(const SourceDocument& document, std::size_t material) {
    const Json* json = item_of(document.json, "materials", material);
    const Json* name = json ? find_path(*json, {"name"}) : nullptr;
    return name && name->is_string() ? name->get<std::string>()
                                     : fmt::format("materials[{}]", material);
}

bool has_same_bytes(const SourceDocument& document, const Json& a, const Json& b) {
    if (!a.is_number_unsigned() || !b.is_number_unsigned()) return false;
    if (a == b) return true;
    try {
        return read_image_bytes(document, a.get<std::size_t>()) ==
               read_image_bytes(document, b.get<std::size_t>());
    } catch (const InputError&) {
        return false;
    }
}

void find_extensions(const Json& value, std::set<std::string>& names) {
    if (!value.is_structured()) return;
    for (const auto& [key, child] : value.items()) {
        if (value.is_object() && key == "extensions" && child.is_object()) {
            for (const auto& [name, extension] : child.items())
                names.insert(name);
        }
        find_extensions(child, names);
    }
}

}  // namespace

bool is_texture_info(const std::string& key, const Json& value) {
    if (!value.is_object() || key.size() < 7) return false;
    const auto index = value.find("index");
    return index != value.end() && index->is_number_unsigned() &&
           (key.ends_with("Texture") || key.ends_with("texture"));
}

bool shows_same_image(const SourceDocument& document, std::size_t a, std::size_t b) {
    if (a == b) return true;
    const Json* first = item_of(document.json, "textures", a);
    const Json* second = item_of(document.json, "textures", b);
    if (!first || !second) return false;
    const Json* one = find_path(*first, {"source"});
    const Json* other = find_path(*second, {"source"});
    if (one && other) return has_same_bytes(document, *one, *other);
    const Json* extension = find_path(*first, {"extensions"});
    const Json* other_extension = find_path(*second, {"extensions"});
    return !one && !other && extension && other_extension && *extension == *other_extension;
}

void move_texture_coordinates(Json& value, std::size_t set) {
    if (!value.is_structured()) return;
    for (auto& [key, child] : value.items()) {
        if (!is_texture_info(key, child)) {
            move_texture_coordinates(child, set);
            continue;
        }
        if (child.value("texCoord", std::size_t{0}) == 0) child["texCoord"] = set;
        const auto extensions = child.find("extensions");
        if (extensions == child.end() || !extensions->contains(transform_name)) continue;
        Json& transform = (*extensions)[transform_name];
        if (transform.contains("texCoord") && transform["texCoord"] == 0)
            transform["texCoord"] = set;
    }
}

const ReplacedTexture* find_replaced(const SourceDocument& document,
                                     const std::vector<ReplacedTexture>& replaced,
                                     std::size_t texture) {
    const auto found =
        std::find_if(replaced.begin(), replaced.end(), [&](const ReplacedTexture& one) {
            return shows_same_image(document, one.old_texture, texture);
        });
    return found == replaced.end() ? nullptr : &*found;
}

void follow_vrm(const SourceDocument& document, std::size_t material,
                const std::vector<ReplacedTexture>& replaced, bool new_uvs, Json& json) {
    const std::string place =
        document.path.string() + ": material '" + name_of(document, material) + "': ";
    const Json* list = find_path(document.json, {"extensions", "VRM", "materialProperties"});
    if (list && list->is_array() && material < list->size() && (*list)[material].is_object()) {
        Json& properties = json["extensions"]["VRM"]["materialProperties"][material];
        const bool has_new_base =
            std::any_of(replaced.begin(), replaced.end(),
                        [](const ReplacedTexture& one) { return one.is_base_color; });
        if (Json* colors =
                properties.contains("vectorProperties") ? &properties["vectorProperties"] : nullptr;
            has_new_base && colors && colors->is_object()) {
            // The colour becomes white, as baseColorFactor does, because the new image contains the
            // colour.
            const auto color = colors->find("_Color");
            if (color != colors->end() && color->is_array() && color->size() == 4) {
                for (std::size_t c = 0; c < 3; ++c)
                    (*color)[c] = 1;
            }
            if (new_uvs && colors->contains("_MainTex"))
                (*colors)["_MainTex"] = Json::array({0, 0, 1, 1});
        }
        std::vector<std::string> kept;
        if (properties.contains("textureProperties")) {
            for (auto& [key, texture] : properties["textureProperties"].items()) {
                if (!texture.is_number_unsigned()) continue;
                const ReplacedTexture* found =
                    find_replaced(document, replaced, texture.get<std::size_t>());
                if (found)
                    texture = found->new_texture;
                else if (key != "_SphereAdd" && (new_uvs || key == "_ShadeTexture"))
                    kept.push_back(key);
            }
        }
        if (!kept.empty() && !replaced.empty()) {
            warn(fmt::format("{}its VRM textures {} were not edited{}", place,
                             fmt::join(kept, ", "),
                             new_uvs ? " and do not fit its new UV map" : ""));
        }
    }
    const Json* source = item_of(document.json, "materials", material);
    const Json* shade = source ? find_path(*source, {"extensions", "VRMC_materials_mtoon",
                                                     "shadeMultiplyTexture", "index"})
                               : nullptr;
    if (shade && shade->is_number_unsigned() && !replaced.empty() &&
        !find_replaced(document, replaced, shade->get<std::size_t>())) {
        warn(place +
             "its shadeMultiplyTexture is a separate image that was not edited, so the shaded side "
             "keeps the old look");
    }
}

void warn_of_animations(const SourceDocument& document, std::size_t material) {
    const Json* animations = find_path(document.json, {"animations"});
    if (!animations || !animations->is_array()) return;
    const std::string prefix = fmt::format("/materials/{}/", material);
    for (const Json& animation : *animations) {
        const Json* channels = find_path(animation, {"channels"});
        if (!channels || !channels->is_array()) continue;
        for (const Json& channel : *channels) {
            const Json* pointer =
                find_path(channel, {"target", "extensions", "KHR_animation_pointer", "pointer"});
            if (!pointer || !pointer->is_string()) continue;
            const std::string target = pointer->get<std::string>();
            if (!target.starts_with(prefix)) continue;
            warn(fmt::format("{}: material '{}': an animation still changes its {}",
                             document.path.string(), name_of(document, material),
                             target.substr(prefix.size())));
            return;
        }
    }
}

std::vector<std::size_t> lod_materials(const SourceDocument& document, std::size_t material) {
    std::vector<std::size_t> materials;
    const Json* source = item_of(document.json, "materials", material);
    const Json* ids = source ? find_path(*source, {"extensions", "MSFT_lod", "ids"}) : nullptr;
    if (!ids || !ids->is_array()) return materials;
    for (const Json& id : *ids) {
        if (id.is_number_unsigned() && item_of(document.json, "materials", id.get<std::size_t>()))
            materials.push_back(id.get<std::size_t>());
    }
    return materials;
}

void keep_unseen_meshes(const SourceDocument& document, const std::set<std::pair<int, int>>& shown,
                        const std::set<int>& materials, Json& json) {
    std::map<std::size_t, std::size_t> copies;
    const auto keep = [&](Json& owner, std::size_t mesh) {
        const auto found = owner.find("material");
        if (found == owner.end()) return;
        const auto material = found->get<std::size_t>();
        if (!materials.contains(static_cast<int>(material))) return;
        const auto [copy, is_new] = copies.try_emplace(material, json["materials"].size());
        if (is_new) {
            json["materials"].push_back(document.json["materials"][material]);
            warn(fmt::format(
                "{}: meshes[{}] is not in the default scene and keeps the unedited material '{}'",
                document.path.string(), mesh, name_of(document, material)));
        }
        owner["material"] = copy->second;
    };
    const std::size_t meshes =
        document.json.contains("meshes") ? document.json["meshes"].size() : 0;
    for (std::size_t m = 0; m < meshes; ++m) {
        Json& primitives = json["meshes"][m]["primitives"];
        for (std::size_t p = 0; p < primitives.size(); ++p) {
            if (shown.contains({static_cast<int>(m), static_cast<int>(p)})) continue;
            Json& primitive = primitives[p];
            keep(primitive, m);
            if (!find_path(primitive, {"extensions", "KHR_materials_variants", "mappings"}))
                continue;
            for (Json& mapping : primitive["extensions"]["KHR_materials_variants"]["mappings"])
                keep(mapping, m);
        }
    }
}

void forget_unused_extensions(const Json& before, Json& after) {
    std::set<std::string> had, has;
    find_extensions(before, had);
    find_extensions(after, has);
    for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
        if (!after.contains(key) || !after[key].is_array()) continue;
        Json kept = Json::array();
        for (const Json& name : after[key]) {
            const bool is_gone = name.is_string() && had.contains(name.get<std::string>()) &&
                                 !has.contains(name.get<std::string>());
            if (!is_gone) kept.push_back(name);
        }
        if (kept.size() == after[key].size()) continue;
        if (kept.empty()) {
            after.erase(key);
        } else {
            after[key] = std::move(kept);
        }
    }
}

}  // namespace item3d
