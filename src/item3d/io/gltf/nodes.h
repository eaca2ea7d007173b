// The node tree of a glTF. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"

#include <glm/glm.hpp>

namespace item3d {

struct NodeTree {
    /// Node-to-world matrix of every node of the document.
    std::vector<glm::dmat4> world;
    /// Nodes of the default scene in depth-first order (all nodes when there is no scene), without
    /// those that KHR_node_visibility hides.
    std::vector<std::size_t> scene;
};

/// Reads the node tree. Throws InputError if nodes form a cycle or have two parents, or an index is
/// out of range.
NodeTree read_nodes(const SourceDocument& document);

}  // namespace item3d
