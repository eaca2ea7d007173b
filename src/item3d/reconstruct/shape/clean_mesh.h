// Cleaning of a mesh extracted from a lattice.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>

namespace item3d {

struct TriangleMesh {
    at::Tensor positions;  ///< [V, 3] float32
    at::Tensor triangles;  ///< [T, 3] int64
};

/// Removes connected parts whose area is less than `share` of the largest part's area. Such specks
/// arise in regions that few images show.
TriangleMesh without_specks(const TriangleMesh& mesh, double share = 0.02);

/// Removes connected parts, except the largest, whose vertices appear in fewer than `fewest` views
/// on average. So few views are no evidence that a part exists. shown: [V], number of views that
/// show each vertex.
TriangleMesh without_ghosts(const TriangleMesh& mesh, const at::Tensor& shown, double fewest);

/// Simplifies a mesh to about `triangles` triangles or fewer (meshoptimizer's quadric simplifier),
/// and removes unused vertices.
TriangleMesh simplified(const TriangleMesh& mesh, std::int64_t triangles);

/// Returns the enclosed volume of a closed mesh; negative if it is inside out.
double enclosed_volume(const TriangleMesh& mesh);

}  // namespace item3d
