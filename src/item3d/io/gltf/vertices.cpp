#include "item3d/io/gltf/vertices.h"

#include "item3d/io/gltf/accessors.h"
#include "item3d/io/gltf/skin.h"

namespace item3d {
namespace {

glm::dvec3 to_dvec3(const Accessor& accessor, std::size_t i) {
    return {accessor.value(i, 0), accessor.value(i, 1), accessor.value(i, 2)};
}

std::optional<std::size_t> accessor_of(const SourceDocument& document, const GltfObject& object,
                                       const char* key) {
    return object.index(key, root_of(document).list_size("accessors"));
}

}  // namespace

Vertices read_vertices(const SourceDocument& document, const GltfObject& attributes) {
    Vertices vertices;
    const Accessor positions =
        read_vectors(document, *accessor_of(document, attributes, "POSITION"), 3, 3);
    vertices.positions.resize(positions.count);
    for (std::size_t i = 0; i < positions.count; ++i)
        vertices.positions[i] = to_dvec3(positions, i);
    if (const auto index = accessor_of(document, attributes, "NORMAL")) {
        const Accessor normals = read_vectors(document, *index, 3, 3);
        check_count(attributes, "NORMAL", normals.count, positions.count);
        vertices.normals.resize(normals.count);
        for (std::size_t i = 0; i < normals.count; ++i)
            vertices.normals[i] = to_dvec3(normals, i);
    }
    if (const auto index = accessor_of(document, attributes, "TANGENT")) {
        const Accessor tangents = read_vectors(document, *index, 4, 4);
        check_count(attributes, "TANGENT", tangents.count, positions.count);
        vertices.tangents.resize(tangents.count);
        for (std::size_t i = 0; i < tangents.count; ++i) {
            vertices.tangents[i] = glm::dvec4(to_dvec3(tangents, i), tangents.value(i, 3));
        }
    }
    return vertices;
}

void apply_morph_targets(const SourceDocument& document, const GltfObject& source,
                         const std::vector<double>& weights, Vertices& vertices) {
    for (std::size_t t = 0; t < weights.size(); ++t) {
        if (weights[t] == 0.0) continue;
        const GltfObject target = source.item("targets", t);
        const auto add = [&](const char* name, auto& values) {
            const auto index = accessor_of(document, target, name);
            if (!index || values.empty()) return;
            const Accessor offsets = read_vectors(document, *index, 3, 3);
            check_count(target, name, offsets.count, values.size());
            for (std::size_t i = 0; i < offsets.count; ++i) {
                for (int c = 0; c < 3; ++c)
                    values[i][c] += weights[t] * offsets.value(i, c);
            }
        };
        add("POSITION", vertices.positions);
        add("NORMAL", vertices.normals);
        add("TANGENT", vertices.tangents);
    }
}

}  // namespace item3d
