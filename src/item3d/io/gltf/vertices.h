// Positions, normals and tangents of glTF primitives. Internal to io.
#pragma once

#include "item3d/io/gltf/document.h"

#include <glm/glm.hpp>

#include <vector>

namespace item3d {

/// Vertex attributes in the space of the mesh.
struct Vertices {
    std::vector<glm::dvec3> positions;
    std::vector<glm::dvec3> normals;
    std::vector<glm::dvec4> tangents;
};

/// Reads the vertex attributes of a primitive. Throws InputError if their numbers of elements
/// differ.
Vertices read_vertices(const SourceDocument& document, const GltfObject& attributes);

/// Adds the weighted offsets of the primitive's morph targets. Throws InputError.
void apply_morph_targets(const SourceDocument& document, const GltfObject& source,
                         const std::vector<double>& weights, Vertices& vertices);

}  // namespace item3d
