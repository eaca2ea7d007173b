// Normals for glTF meshes whose file has none. Internal to scene/io.
#pragma once

#include "item3d/scene/model.h"

#include <vector>

namespace item3d {

/// What glTF asks for then: flat shading, and tangents of the file without effect. Every corner
/// becomes a vertex of its own, in the order of the file (so that all nodes with the mesh, mirrored
/// or not, number them alike). Returns, for each new vertex, the one that it was.
std::vector<std::uint32_t> make_flat(Primitive& primitive);

}  // namespace item3d
