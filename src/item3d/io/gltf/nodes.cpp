#include "item3d/io/gltf/nodes.h"

#include "item3d/io/gltf/uv_layouts.h"

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

namespace item3d {
namespace {

glm::dmat4 local_matrix(const GltfObject& node) {
    if (const auto m = node.numbers("matrix", 16); !m.empty()) {
        glm::dmat4 matrix;
        for (int column = 0; column < 4; ++column) {
            for (int row = 0; row < 4; ++row)
                matrix[column][row] = m[column * 4 + row];
        }
        return matrix;
    }
    const auto t = node.numbers("translation", 3);
    const auto r = node.numbers("rotation", 4);
    const auto s = node.numbers("scale", 3);
    glm::dmat4 matrix(1.0);
    if (!r.empty()) {
        const glm::dquat rotation(r[3], r[0], r[1], r[2]);
        const double length = glm::length(rotation);
        if (length > 0.0) matrix = glm::mat4_cast(rotation / length);
    }
    if (!s.empty()) {
        for (int c = 0; c < 3; ++c)
            matrix[c] *= s[c];
    }
    if (!t.empty()) matrix[3] = glm::dvec4(t[0], t[1], t[2], 1.0);
    return matrix;
}

/// True if the node, and thus its descendants, are hidden.
bool is_hidden(const GltfObject& node) {
    const auto visibility = find_extension(node, "KHR_node_visibility");
    return visibility && !visibility->boolean("visible", true);
}

}  // namespace

NodeTree read_nodes(const SourceDocument& document) {
    constexpr std::size_t none = static_cast<std::size_t>(-1);
    const GltfObject root = root_of(document);
    const std::size_t count = root.list_size("nodes");
    std::vector<std::size_t> parents(count, none);
    std::vector<std::vector<std::size_t>> children(count);
    NodeTree tree;
    for (std::size_t i = 0; i < count; ++i) {
        const GltfObject node = root.item("nodes", i);
        tree.world.push_back(local_matrix(node));
        for (std::size_t k = 0; k < node.list_size("children"); ++k) {
            const std::size_t child = node.index_item("children", k, count);
            if (parents[child] != none) {
                node.fail(fmt::format("node {} is also a child of node {}", child, parents[child]),
                          "nodes must form a tree");
            }
            parents[child] = i;
            children[i].push_back(child);
        }
    }

    // The order has parents before children. Nodes that are missing in it are part of a cycle.
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < count; ++i) {
        if (parents[i] == none) order.push_back(i);
    }
    const std::vector<std::size_t> roots = order;
    for (std::size_t k = 0; k < order.size(); ++k) {
        const std::size_t i = order[k];
        if (parents[i] != none) tree.world[i] = tree.world[parents[i]] * tree.world[i];
        order.insert(order.end(), children[i].begin(), children[i].end());
    }
    if (order.size() != count) root.fail("its nodes form a cycle", "nodes must form a tree");

    std::vector<std::size_t> stack;
    if (root.list_size("scenes") > 0) {
        const GltfObject scene =
            root.item("scenes", root.index("scene", root.list_size("scenes")).value_or(0));
        for (std::size_t k = scene.list_size("nodes"); k-- > 0;) {
            stack.push_back(scene.index_item("nodes", k, count));
        }
    } else {
        stack.assign(roots.rbegin(), roots.rend());
    }
    std::vector<bool> seen(count, false);
    while (!stack.empty()) {
        const std::size_t i = stack.back();
        stack.pop_back();
        if (seen[i]) continue;
        seen[i] = true;
        if (is_hidden(root.item("nodes", i))) continue;
        tree.scene.push_back(i);
        stack.insert(stack.end(), children[i].rbegin(), children[i].rend());
    }
    return tree;
}

}  // namespace item3d
