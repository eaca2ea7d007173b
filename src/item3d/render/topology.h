// Adjacency of triangles across shared edges, ignoring seams of UVs or normals.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// Returns [T, 3] int32 as Geometry::neighbours describes. positions: [V, 3] float32; triangles:
/// [T, 3] int32. Vertices at equal positions are merged. An edge of only one triangle, or of more
/// than two, has no neighbours, so its entries are -1.
at::Tensor triangle_neighbours(const at::Tensor& positions, const at::Tensor& triangles);

}  // namespace item3d
