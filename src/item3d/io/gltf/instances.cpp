#include "item3d/io/gltf/instances.h"

#include "item3d/io/gltf/accessors.h"
#include "item3d/io/gltf/uv_layouts.h"

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

namespace item3d {

std::optional<std::vector<glm::dmat4>> read_instances(const SourceDocument& document,
                                                      const NodeTree& nodes, std::size_t node) {
    const GltfObject root = root_of(document);
    const auto extension = find_extension(root.item("nodes", node), "EXT_mesh_gpu_instancing");
    if (!extension) return std::nullopt;
    const auto attributes = extension->object("attributes");
    if (!attributes) extension->fail("attributes is missing");
    std::optional<std::size_t> count;
    const auto read = [&](const char* name, std::size_t components) -> std::optional<Accessor> {
        const auto index = attributes->index(name, root.list_size("accessors"));
        if (!index) return std::nullopt;
        Accessor accessor = read_vectors(document, *index, components, components);
        if (count && *count != accessor.count) {
            attributes->fail(
                fmt::format("{} has {} elements, others {}", name, accessor.count, *count));
        }
        count = accessor.count;
        return accessor;
    };
    const auto translation = read("TRANSLATION", 3);
    const auto rotation = read("ROTATION", 4);
    const auto scale = read("SCALE", 3);
    // Attributes other than TRANSLATION, ROTATION and SCALE do not transform the instances.
    if (!count) return std::nullopt;
    std::vector<glm::dmat4> matrices(*count, nodes.world[node]);
    for (std::size_t i = 0; i < *count; ++i) {
        glm::dmat4 local(1.0);
        if (rotation) {
            const glm::dquat turn(rotation->value(i, 3), rotation->value(i, 0),
                                  rotation->value(i, 1), rotation->value(i, 2));
            const double length = glm::length(turn);
            if (length > 0.0) local = glm::mat4_cast(turn / length);
        }
        for (int c = 0; c < 3; ++c) {
            const auto component = static_cast<std::size_t>(c);
            if (scale) local[c] *= static_cast<double>(scale->value(i, component));
            if (translation) local[3][c] = translation->value(i, component);
        }
        matrices[i] = nodes.world[node] * local;
    }
    return matrices;
}

}  // namespace item3d
