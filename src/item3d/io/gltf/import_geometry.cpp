#include "item3d/io/gltf/import_geometry.h"

#include "item3d/io/gltf/draco.h"
#include "item3d/io/gltf/references.h"

namespace item3d {

Json GeometryImport::add_attributes(DocumentContent& content, const Json& attributes) {
    const SourceDocument& document = content.document();
    Json added = Json::object();
    for (const auto& [name, index] : attributes.items()) {
        const auto number = index.get<std::size_t>();
        const bool has_bounds = document.json["accessors"].at(number).contains("min");
        const std::string key = content.accessor(number) + (has_bounds ? " with bounds" : "");
        const auto [found, is_new] = accessors_.try_emplace(key);
        if (is_new) {
            const Accessor read = read_accessor(document, number);
            found->second = builder_.add_vertices(read, read.bytes, has_bounds);
        }
        added[name] = found->second;
    }
    return added;
}

void GeometryImport::replace(DocumentContent& content, const Json& edited, std::size_t uv_set,
                             Json& primitive) {
    const SourceDocument& document = content.document();
    primitive["attributes"] = add_attributes(content, edited.at("attributes"));
    if (primitive.contains("targets")) {
        primitive["targets"] = Json::array();
        for (const Json& target : edited.at("targets"))
            primitive["targets"].push_back(add_attributes(content, target));
    }
    const auto indices = edited.at("indices").get<std::size_t>();
    const auto [found, is_new] = accessors_.try_emplace("triangles " + content.accessor(indices));
    if (is_new) {
        const auto position = edited.at("attributes").at("POSITION").get<std::size_t>();
        found->second = builder_.add_indices(read_indices(document, indices),
                                             accessor_shape(document, position).count);
    }
    primitive["indices"] = found->second;
    primitive.erase("mode");
    if (!primitive.contains("extensions")) return;
    primitive["extensions"].erase(draco_extension);
    if (uv_set > 0) move_texture_coordinates(primitive["extensions"], uv_set);
    if (primitive["extensions"].empty()) primitive.erase("extensions");
}

}  // namespace item3d
