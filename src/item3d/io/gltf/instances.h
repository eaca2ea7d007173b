// EXT_mesh_gpu_instancing: nodes with several instances of their mesh. Internal to io.
#pragma once

#include "item3d/io/gltf/nodes.h"

#include <optional>
#include <vector>

namespace item3d {

/// Returns the instance-to-world matrices of a node's mesh; no value for a node without the
/// extension. Throws InputError.
std::optional<std::vector<glm::dmat4>> read_instances(const SourceDocument& document,
                                                      const NodeTree& nodes, std::size_t node);

}  // namespace item3d
