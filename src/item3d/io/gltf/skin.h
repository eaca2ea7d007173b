// Skinned meshes in their rest pose. Internal to io.
#pragma once

#include "item3d/io/gltf/nodes.h"

#include <vector>

namespace item3d {

/// Throws InputError unless an attribute has as many elements as POSITION.
void check_count(const GltfObject& attributes, const char* name, std::size_t count,
                 std::size_t expected);

/// Returns one matrix for each of `count` vertices: the weighted mean of its joints' matrices.
/// Throws InputError.
std::vector<glm::dmat4> blend_joints(const SourceDocument& document, const NodeTree& nodes,
                                     const GltfObject& attributes, std::size_t skin,
                                     std::size_t count);

}  // namespace item3d
