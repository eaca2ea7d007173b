// Skinned meshes at rest. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"
#include "item3d/io/gltf/nodes.h"

#include <glm/glm.hpp>

#include <vector>

namespace item3d {

/// One matrix for each of `count` vertices: the mean of its joints', weighted by JOINTS_n and
/// WEIGHTS_n. Throws InputError.
std::vector<glm::dmat4> blend_joints(const SourceDocument& document, const NodeTree& nodes,
                                     const GltfObject& attributes, std::size_t skin,
                                     std::size_t count);

}  // namespace item3d
