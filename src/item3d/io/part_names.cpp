#include "item3d/io/part_names.h"

#include "item3d/core/error.h"
#include "item3d/io/gltf/accessors.h"
#include "item3d/io/gltf/document.h"

#include <set>

namespace item3d {
namespace {

std::string name_of(const Json& document, const char* list, int index) {
    const Json& thing = document.at(list).at(static_cast<std::size_t>(index));
    const auto name = thing.find("name");
    return name != thing.end() && name->is_string() ? name->get<std::string>() : std::string();
}

/// Returns the parent of each node; -1 if it has none.
std::vector<int> parents(const Json& document) {
    const Json& nodes = document.at("nodes");
    std::vector<int> parent(nodes.size(), -1);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (!nodes[i].contains("children")) continue;
        for (const Json& child : nodes[i]["children"]) {
            if (!child.is_number_unsigned()) continue;
            const auto index = child.get<std::size_t>();
            if (index < parent.size()) parent[index] = static_cast<int>(i);
        }
    }
    return parent;
}

/// Returns null where the primitive is not from glTF.
const Json* attributes_of(const Model& model, const Primitive& primitive) {
    if (!model.source || primitive.source_mesh < 0) return nullptr;
    const Json& source = model.source->json.at("meshes")
                             .at(static_cast<std::size_t>(primitive.source_mesh))
                             .at("primitives")
                             .at(static_cast<std::size_t>(primitive.source_primitive));
    const auto attributes = source.find("attributes");
    return attributes == source.end() ? nullptr : &*attributes;
}

}  // namespace

std::vector<std::string> node_names(const Model& model, const Primitive& primitive) {
    std::vector<std::string> names;
    if (!model.source || primitive.source_node < 0) return names;
    const Json& document = model.source->json;
    const std::vector<int> parent = parents(document);
    std::size_t steps = 0;
    for (int node = primitive.source_node; node >= 0 && steps < parent.size();
         node = parent.at(static_cast<std::size_t>(node)), ++steps) {
        std::string name = name_of(document, "nodes", node);
        if (!name.empty()) names.push_back(std::move(name));
    }
    return names;
}

std::string mesh_name(const Model& model, const Primitive& primitive) {
    if (!model.source || primitive.source_mesh < 0) return "";
    return name_of(model.source->json, "meshes", primitive.source_mesh);
}

std::vector<std::string> vertex_attribute_names(const Model& model) {
    std::set<std::string> names;
    for (const Primitive& primitive : model.primitives) {
        const Json* attributes = attributes_of(model, primitive);
        if (attributes == nullptr) continue;
        for (const auto& [name, accessor] : attributes->items())
            if (name.starts_with('_')) names.insert(name);
    }
    return {names.begin(), names.end()};
}

std::vector<float> vertex_attribute(const Model& model, const Primitive& primitive,
                                    const std::string& name) {
    const Json* attributes = attributes_of(model, primitive);
    if (attributes == nullptr || !attributes->contains(name)) return {};
    const SourceDocument& document = *model.source;
    const std::string where = document.path.string() + ": attribute " + name;
    if (!(*attributes)[name].is_number_unsigned()) throw InputError(where, "expected an accessor");
    const Accessor accessor = read_accessor(document, (*attributes)[name].get<std::size_t>());
    const auto split =
        document.split_vertices.find({primitive.source_mesh, primitive.source_primitive});
    std::vector<float> values(primitive.positions.size());
    for (std::size_t v = 0; v < values.size(); ++v) {
        const std::size_t vertex = split == document.split_vertices.end() ? v : split->second.at(v);
        if (vertex >= accessor.count)
            throw InputError(where, "it has fewer elements than there are vertices",
                             "export the model again");
        values[v] = accessor.value(vertex, 0);
    }
    return values;
}

}  // namespace item3d
