// Which triangles share an edge, whatever seams of UVs or normals lie between them.
#pragma once

#include "item3d/tensors/tensor.h"

namespace item3d {

/// positions [V, 3] float32, triangles [T, 3] int32 -> [T, 3] int32 as Geometry::neighbours says.
/// Vertices at equal positions are one. Edges of one triangle, or of more than two: -1.
at::Tensor triangle_neighbours(const at::Tensor& positions, const at::Tensor& triangles);

}  // namespace item3d
