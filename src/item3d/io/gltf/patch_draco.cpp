#include "item3d/io/gltf/draco.h"
#include "item3d/io/gltf/patch.h"

namespace item3d {
namespace {

bool has_draco(const Json& primitive) {
    const auto extensions = primitive.find("extensions");
    return extensions != primitive.end() && extensions->contains(draco_extension);
}

}  // namespace

// What was renamed or dropped in the primitive must be in the extension too, and what is plain and
// new must not be in it, where the compressed values would be taken in its stead.
void match_draco(const Json& original, Json& primitive) {
    if (!has_draco(primitive)) return;
    Json& extension = primitive["extensions"][draco_extension];
    if (!extension.contains("attributes")) return;
    const Json old_ids = extension["attributes"];
    Json ids = Json::object();
    for (const auto& [name, accessor] : primitive["attributes"].items()) {
        for (const auto& [old_name, id] : old_ids.items()) {
            const auto old_accessor = original["attributes"].find(old_name);
            if (old_accessor != original["attributes"].end() && *old_accessor == accessor)
                ids[name] = id;
        }
    }
    extension["attributes"] = std::move(ids);
}

// A viewer without Draco may show the model then.
void forget_unused_draco(Json& json) {
    for (const Json& mesh : json["meshes"]) {
        for (const Json& primitive : mesh["primitives"]) {
            if (has_draco(primitive)) return;
        }
    }
    for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
        if (!json.contains(key)) continue;
        Json kept = Json::array();
        for (const Json& name : json[key]) {
            if (name != draco_extension) kept.push_back(name);
        }
        if (kept.empty()) {
            json.erase(key);
        } else {
            json[key] = std::move(kept);
        }
    }
}

}  // namespace item3d
