// What the file calls the parts of a model: nodes, meshes, vertex attributes.
#pragma once

#include "item3d/scene/model.h"

#include <string>
#include <vector>

namespace item3d {

/// Names of a primitive's node and of all nodes above it, the nearest first; of its mesh alone.
/// Empty for a model that is not from glTF, and where the file gives no name.
std::vector<std::string> node_names(const Model& model, const Primitive& primitive);
std::string mesh_name(const Model& model, const Primitive& primitive);

/// Names of the vertex attributes that are no standard ones ("_HANDLE"), in rising order.
std::vector<std::string> vertex_attribute_names(const Model& model);

/// The first component of such an attribute, one a vertex; empty where the primitive has none.
/// Throws InputError where it cannot be read.
std::vector<float> vertex_attribute(const Model& model, const Primitive& primitive,
                                    const std::string& name);

}  // namespace item3d
