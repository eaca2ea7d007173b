// Names that a model's file gives its parts: nodes, meshes, vertex attributes.
#pragma once

#include "item3d/scene/model.h"

#include <string>
#include <vector>

namespace item3d {

/// node_names() returns the names of a primitive's node and all its ancestors, the nearest first;
/// mesh_name() returns the name of its mesh. Names are empty if the model is not from glTF, or the
/// file has no name.
std::vector<std::string> node_names(const Model& model, const Primitive& primitive);
std::string mesh_name(const Model& model, const Primitive& primitive);

/// Returns the sorted names of the non-standard vertex attributes ("_HANDLE").
std::vector<std::string> vertex_attribute_names(const Model& model);

/// Returns the first component of the named vertex attribute for each vertex; empty if the
/// primitive does not have the attribute. Throws InputError where it cannot be read.
std::vector<float> vertex_attribute(const Model& model, const Primitive& primitive,
                                    const std::string& name);

}  // namespace item3d
