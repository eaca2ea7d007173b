#include "item3d/io/gltf/light.h"

#include "item3d/core/error.h"
#include "item3d/io/gltf/builder.h"
#include "item3d/io/gltf/document.h"
#include "item3d/io/gltf/image_light.h"
#include "item3d/io/gltf/write.h"
#include "item3d/io/resources.h"
#include "item3d/io/save.h"
#include "item3d/io/text.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace item3d {

namespace {

namespace fs = std::filesystem;

constexpr const char* punctual = "KHR_lights_punctual";

bool refers_to_files(const Json& json) {
    for (const char* list : {"buffers", "images"}) {
        if (!json.contains(list)) continue;
        for (const Json& item : json[list]) {
            const std::string uri = item.value("uri", std::string());
            if (!uri.empty() && !is_data_uri(uri)) return true;
        }
    }
    return false;
}

/// Returns the quaternion x, y, z, w that turns +Z towards `direction`, so that a light, which
/// shines along -Z, comes from there.
Json rotation_towards(Vec3 direction) {
    if (direction.z < -0.99999f) return Json{0, 1, 0, 0};
    const Vec3 axis = glm::cross(Vec3(0, 0, 1), direction);
    const Vec4 q = glm::normalize(Vec4(axis, 1 + direction.z));
    return Json{q.x, q.y, q.z, q.w};
}

/// Returns the nodes without parents.
Json root_nodes(const Json& json) {
    std::set<std::size_t> children;
    for (const Json& node : json["nodes"]) {
        if (!node.contains("children")) continue;
        for (const Json& child : node["children"])
            children.insert(child.get<std::size_t>());
    }
    Json roots = Json::array();
    for (std::size_t i = 0; i < json["nodes"].size(); ++i)
        if (!children.contains(i)) roots.push_back(i);
    return roots;
}

/// Returns the default scene. If there is none, creates a scene of all nodes, as the loader does.
Json& default_scene(Json& json) {
    if (!json.contains("scenes") || json["scenes"].empty()) {
        json["scenes"] = Json::array({Json{{"nodes", root_nodes(json)}}});
        json["scene"] = 0;
    }
    return json["scenes"][json.value("scene", std::size_t{0})];
}

void use_extension(Json& json, const char* name) {
    if (!json.contains("extensionsUsed")) json["extensionsUsed"] = Json::array();
    Json& used = json["extensionsUsed"];
    if (std::find(used.begin(), used.end(), name) == used.end()) used.push_back(name);
}

void add_sun(Json& json, const DirectionalLight& sun) {
    const float strongest = std::max({sun.irradiance.x, sun.irradiance.y, sun.irradiance.z});
    ITEM3D_CHECK(strongest > 0, "a directional light shines");
    const Vec3 color = sun.irradiance / strongest;
    const std::size_t light = append(json["extensions"][punctual], "lights",
                                     Json{{"type", "directional"},
                                          {"name", "sun"},
                                          {"color", {color.x, color.y, color.z}},
                                          {"intensity", strongest}});
    Json& scene = default_scene(json);
    append(scene, "nodes", json["nodes"].size());
    append(json, "nodes",
           Json{{"name", "sun"},
                {"rotation", rotation_towards(sun.direction)},
                {"extensions", {{punctual, {{"light", light}}}}}});
    use_extension(json, punctual);
}

Bytes with_lights(const SourceDocument& document, const ModelLights& lights) {
    Json json = document.json;
    GltfBuilder builder(json, 0, document.has_binary_chunk ? document.buffers[0] : Bytes(), false,
                        "");
    if (lights.sun) add_sun(json, *lights.sun);
    if (lights.surroundings) {
        const std::size_t light = add_image_based_light(builder, *lights.surroundings);
        default_scene(json)["extensions"][image_based_extension] = Json{{"light", light}};
        use_extension(json, image_based_extension);
    }
    builder.finish();
    return to_glb(json, builder.binary(), document);
}

}  // namespace

void save_lit_model(const fs::path& path, const Model& model, const ModelLights& lights,
                    const Provenance& provenance) {
    if (to_lower(path.extension().string()) != ".glb") {
        throw InputError(path.string(), "a model with its light is written as .glb",
                         "choose a name that ends in .glb");
    }
    const bool is_whole_glb = model.source &&
                              to_lower(model.source->path.extension().string()) == ".glb" &&
                              !refers_to_files(model.source->json);
    const bool has_lights = lights.sun || lights.surroundings;
    if (!has_lights && is_whole_glb) {
        write_atomically(path, std::span<const std::uint8_t>(read_bytes(model.source->path)));
        return;
    }
    write_atomically(path, [&](const fs::path& temporary) {
        save_model(temporary, model);
        if (!has_lights) return;
        const auto document = parse_gltf(temporary, read_bytes(temporary));
        const Bytes lit = with_lights(*document, lights);
        write_atomically(temporary, std::span<const std::uint8_t>(
                                        claimed_glb(path, lit, *document, provenance)));
    });
}

}  // namespace item3d
