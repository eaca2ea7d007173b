#include "item3d/io/gltf/skin.h"

#include "item3d/io/gltf/accessors.h"

#include <fmt/format.h>

namespace item3d {
namespace {

std::vector<glm::dmat4> joint_matrices(const SourceDocument& document, const NodeTree& nodes,
                                       std::size_t index) {
    const GltfObject root = root_of(document);
    const GltfObject skin = root.item("skins", index);
    const std::size_t count = skin.list_size("joints");
    std::vector<glm::dmat4> matrices;
    for (std::size_t j = 0; j < count; ++j) {
        matrices.push_back(nodes.world[skin.index_item("joints", j, nodes.world.size())]);
    }
    if (const auto accessor = skin.index("inverseBindMatrices", root.list_size("accessors"))) {
        const Accessor inverse = read_accessor(document, *accessor);
        if (inverse.type != "MAT4" || inverse.count < count) {
            skin.fail("inverseBindMatrices must contain a MAT4 for each joint");
        }
        for (std::size_t j = 0; j < count; ++j) {
            glm::dmat4 matrix;
            for (int c = 0; c < 16; ++c)
                matrix[c / 4][c % 4] = inverse.value(j, c);
            matrices[j] = matrices[j] * matrix;
        }
    }
    return matrices;
}

}  // namespace

void check_count(const GltfObject& attributes, const char* name, std::size_t count,
                 std::size_t expected) {
    if (count != expected) {
        attributes.fail(fmt::format("{} has {} elements, POSITION {}", name, count, expected));
    }
}

std::vector<glm::dmat4> blend_joints(const SourceDocument& document, const NodeTree& nodes,
                                     const GltfObject& attributes, std::size_t skin,
                                     std::size_t count) {
    const std::vector<glm::dmat4> joints = joint_matrices(document, nodes, skin);
    const std::size_t accessors = root_of(document).list_size("accessors");
    std::vector<glm::dmat4> blended(count, glm::dmat4(0.0));
    std::vector<double> sums(count, 0.0);
    for (int set = 0; attributes.has(fmt::format("JOINTS_{}", set).c_str()); ++set) {
        const std::string joints_name = fmt::format("JOINTS_{}", set);
        const std::string weights_name = fmt::format("WEIGHTS_{}", set);
        const auto joints_index = attributes.index(joints_name.c_str(), accessors);
        const auto weights_index = attributes.index(weights_name.c_str(), accessors);
        if (!weights_index) attributes.fail(weights_name + " is missing");
        const Accessor indices = read_vectors(document, *joints_index, 4, 4);
        const Accessor weights = read_vectors(document, *weights_index, 4, 4);
        check_count(attributes, joints_name.c_str(), indices.count, count);
        check_count(attributes, weights_name.c_str(), weights.count, count);
        for (std::size_t i = 0; i < count; ++i) {
            for (int c = 0; c < 4; ++c) {
                const double weight = weights.value(i, c);
                if (weight == 0.0) continue;
                const double joint = indices.raw(i, c);
                if (!(joint >= 0.0) || joint >= static_cast<double>(joints.size())) {
                    attributes.fail(fmt::format("joint {} of {}", joint, joints.size()));
                }
                blended[i] += weight * joints[static_cast<std::size_t>(joint)];
                sums[i] += weight;
            }
        }
    }
    for (std::size_t i = 0; i < count; ++i) {
        blended[i] = sums[i] > 0.0 ? blended[i] / sums[i] : glm::dmat4(1.0);
    }
    return blended;
}

}  // namespace item3d
