// Tangent frames for normal maps.
#pragma once

#include "python/src/operation.h"

namespace item3d::python {

/// Returns MikkTSpace's tangents of each triangle's corners, [T, 3, 4]: x, y, z, and the
/// handedness. positions, normals: [V, 3]; uvs: [V, 2]; triangles: [T, 3] int32. Throws
/// std::runtime_error.
Tensor tangents(const Tensor& positions, const Tensor& normals, const Tensor& uvs,
                const Tensor& triangles);

}  // namespace item3d::python
