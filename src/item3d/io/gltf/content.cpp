#include "item3d/io/gltf/content.h"

#include "item3d/core/digest.h"
#include "item3d/core/error.h"
#include "item3d/io/gltf/accessors.h"
#include "item3d/io/gltf/claims.h"
#include "item3d/io/gltf/draco.h"

#include <set>

namespace item3d {
namespace {

std::string dumped(const Json& value) {
    const nlohmann::json sorted = value;
    return sorted.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Calls f for the indices of images in a texture: its own and those of its extensions.
void for_each_source(Json& texture, const std::function<void(Json&)>& f) {
    if (texture.contains("source")) f(texture["source"]);
    if (!texture.contains("extensions")) return;
    for (auto& [name, extension] : texture["extensions"].items())
        if (extension.is_object() && extension.contains("source")) f(extension["source"]);
}

std::string uv_attribute(std::size_t set) {
    return "TEXCOORD_" + std::to_string(set);
}

/// Returns position and texture coordinate of each vertex.
std::set<std::string> placed_uvs(const SourceDocument& document, const Json& attributes,
                                 const std::string& uvs) {
    const Accessor position = read_accessor(document, attributes.at("POSITION").get<std::size_t>());
    const Accessor uv = read_accessor(document, attributes.at(uvs).get<std::size_t>());
    std::set<std::string> placed;
    for (std::size_t i = 0; i < std::min(position.count, uv.count); ++i) {
        std::string bytes(
            position.bytes.begin() + static_cast<std::ptrdiff_t>(i * position.element_size),
            position.bytes.begin() + static_cast<std::ptrdiff_t>((i + 1) * position.element_size));
        bytes.append(uv.bytes.begin() + static_cast<std::ptrdiff_t>(i * uv.element_size),
                     uv.bytes.begin() + static_cast<std::ptrdiff_t>((i + 1) * uv.element_size));
        placed.insert(std::move(bytes));
    }
    return placed;
}

}  // namespace

void for_each_texture_index(Json& value, const std::function<void(Json&)>& f) {
    if (!value.is_structured()) return;
    if (value.is_object()) {
        const auto index = value.find("index");
        if (index != value.end() && index->is_number_unsigned()) f(*index);
    }
    for (auto& [key, child] : value.items())
        if (key != "extras") for_each_texture_index(child, f);
}

DocumentContent::DocumentContent(const SourceDocument& document)
    : document_(document), decoded_(document), images_(image_hashes(document)) {
    const GltfObject root = root_of(decoded_);
    for (std::size_t m = 0; m < root.list_size("meshes"); ++m) {
        const GltfObject mesh = root.item("meshes", m);
        for (std::size_t p = 0; p < mesh.list_size("primitives"); ++p) {
            const GltfObject primitive = mesh.item("primitives", p);
            if (needs_draco(decoded_, primitive)) decode_draco_primitive(decoded_, primitive);
        }
    }
}

std::string DocumentContent::texture(std::size_t index) const {
    Json texture = document_.json.at("textures").at(index);
    texture.erase("name");
    if (texture.contains("sampler"))
        texture["sampler"] =
            document_.json.at("samplers").at(texture["sampler"].get<std::size_t>());
    for_each_source(texture, [&](Json& source) {
        source = source.is_number_unsigned() ? images_.at(source.get<std::size_t>()) : "";
    });
    return dumped(texture);
}

std::string DocumentContent::material(std::size_t index) const {
    Json material = document_.json.at("materials").at(index);
    material.erase("name");
    for_each_texture_index(material, [&](Json& texture_index) {
        texture_index = texture(texture_index.get<std::size_t>());
    });
    return dumped(material);
}

const std::string& DocumentContent::accessor(std::size_t index) {
    const auto [found, is_new] = accessors_.try_emplace(index);
    if (!is_new) return found->second;
    const Accessor read = read_accessor(decoded_, index);
    found->second = read.type + std::to_string(static_cast<int>(read.component_type)) +
                    (read.normalized ? "n" : "") + sha256(read.bytes);
    return found->second;
}

const std::string& DocumentContent::geometry(std::size_t mesh, std::size_t primitive) {
    const auto [found, is_new] = geometry_.try_emplace({mesh, primitive});
    if (!is_new) return found->second;
    Json content = document_.json.at("meshes").at(mesh).at("primitives").at(primitive);
    content.erase("material");
    content.erase("extensions");
    content.erase("extras");
    if (!content.contains("mode")) content["mode"] = 4;
    const auto name_content = [&](Json& attributes) {
        for (auto& [name, index] : attributes.items())
            index = accessor(index.get<std::size_t>());
    };
    name_content(content.at("attributes"));
    if (content.contains("targets"))
        for (Json& target : content["targets"])
            name_content(target);
    if (content.contains("indices"))
        content["indices"] = accessor(content["indices"].get<std::size_t>());
    found->second = dumped(content);
    return found->second;
}

std::optional<std::size_t> moved_uv_set(const SourceDocument& source, const Json& primitive,
                                        const SourceDocument& edited,
                                        const Json& edited_primitive) {
    const Json& attributes = primitive.at("attributes");
    if (!attributes.contains(uv_attribute(0))) return std::nullopt;
    const std::set<std::string> before = placed_uvs(source, attributes, uv_attribute(0));
    const Json& now = edited_primitive.at("attributes");
    std::size_t sets = 0;
    while (now.contains(uv_attribute(sets)))
        ++sets;
    // The search starts at the highest set, because a primitive that kept its map has it in two
    // sets.
    for (std::size_t set = sets; set-- > 0;) {
        const std::set<std::string> after = placed_uvs(edited, now, uv_attribute(set));
        if (std::includes(before.begin(), before.end(), after.begin(), after.end())) return set;
    }
    return std::nullopt;
}

}  // namespace item3d
