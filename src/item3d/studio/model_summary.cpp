#include "item3d/studio/model_summary.h"

#include "item3d/core/files.h"
#include "item3d/core/progress.h"
#include "item3d/io/load.h"
#include "item3d/io/part_names.h"
#include "item3d/io/save.h"
#include "item3d/io/text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <set>
#include <span>
#include <string>

namespace item3d {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Extensions for which three.js needs decoders that the page lacks.
constexpr std::array decoded_extensions = {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                           "KHR_texture_basisu"};

/// True if the JSON of a .glb names one of these extensions.
bool needs_decoder(const Bytes& glb) {
    return std::any_of(
        decoded_extensions.begin(), decoded_extensions.end(), [&](const std::string& name) {
            return std::search(glb.begin(), glb.end(), name.begin(), name.end()) != glb.end();
        });
}

void write_glb(const fs::path& file, const Model& model, const fs::path& target) {
    const std::string extension = to_lower(file.extension().string());
    if (extension == ".glb" || extension == ".vrm") {
        const Bytes bytes = read_bytes(file);
        if (!needs_decoder(bytes)) {
            write_atomically(target, std::span<const std::uint8_t>(bytes));
            return;
        }
    }
    Model plain = model;
    plain.source = nullptr;
    save_model(target, plain);
}

Json model_summary(const fs::path& file, const Model& model) {
    std::set<std::string> nodes, meshes, groups;
    bool has_uv = true;
    for (const Primitive& primitive : model.primitives) {
        for (const std::string& name : node_names(model, primitive))
            nodes.insert(name);
        meshes.insert(mesh_name(model, primitive));
        has_uv = has_uv && !primitive.uvs.empty();
    }
    for (const auto& names : model.groups)
        groups.insert(names.begin(), names.end());
    for (auto* names : {&nodes, &meshes, &groups})
        names->erase("");
    Json materials = Json::array();
    for (std::size_t i = 0; i < model.materials.size(); ++i)
        materials.push_back({{"index", i}, {"name", model.materials[i].name}});
    const auto bounds = model.bounds();
    Json corners = Json::array();
    for (const Vec3& corner : bounds)
        corners.push_back(
            {corner.x + model.origin.x, corner.y + model.origin.y, corner.z + model.origin.z});
    return {{"format", to_lower(file.extension().string()).substr(1)},
            {"triangles", model.triangle_count()},
            {"bounds", corners},
            {"has_uv", has_uv},
            {"materials", materials},
            {"nodes", nodes},
            {"meshes", meshes},
            {"groups", groups}};
}

}  // namespace

void write_model_summary(const fs::path& file, const fs::path& folder) {
    const CollectedWarnings warnings;
    const Model model = load_model(file);
    write_glb(file, model, folder / "model.glb");
    Json facts = model_summary(file, model);
    facts["warnings"] = warnings.lines();
    write_atomically(folder / "model.json",
                     facts.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace item3d
