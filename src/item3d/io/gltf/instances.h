// EXT_mesh_gpu_instancing: nodes that show their mesh many times. Internal to io.
#pragma once

#include "item3d/io/gltf/nodes.h"

#include <optional>
#include <vector>

namespace item3d {

/// Instance to world, one a copy of the node's mesh; no value for a node that shows its mesh once.
/// Throws InputError.
std::optional<std::vector<glm::dmat4>> read_instances(const SourceDocument& document,
                                                      const NodeTree& nodes, std::size_t node);

}  // namespace item3d
