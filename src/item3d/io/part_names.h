// Names in the file of a model's parts: nodes, meshes, vertex attributes.
#pragma once

#include "item3d/scene/model.h"

#include <string>
#include <vector>

namespace item3d {

/// Return the names of a primitive's node and all its ancestors, the nearest first; and the name of
/// its mesh. Empty for a model that is not from glTF, and where the file has no name.
std::vector<std::string> node_names(const Model& model, const Primitive& primitive);
std::string mesh_name(const Model& model, const Primitive& primitive);

/// Returns names of the non-standard vertex attributes ("_HANDLE"), in rising order.
std::vector<std::string> vertex_attribute_names(const Model& model);

/// Returns the first component of such an attribute, one for each vertex; empty where the primitive
/// has none. Throws InputError where it cannot be read.
std::vector<float> vertex_attribute(const Model& model, const Primitive& primitive,
                                    const std::string& name);

}  // namespace item3d
