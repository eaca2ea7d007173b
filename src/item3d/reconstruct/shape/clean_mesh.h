// Cleaning of a mesh extracted from a lattice.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>

namespace item3d {

struct TriangleMesh {
    at::Tensor positions;  ///< [V, 3] float32
    at::Tensor triangles;  ///< [T, 3] int64
};

/// Removes connected parts with less than `share` of the largest one's area: specks in corners that
/// few images see.
TriangleMesh without_specks(const TriangleMesh& mesh, double share = 0.02);

/// Removes parts, except the largest, whose vertices are shown by fewer than `fewest` views on
/// average: few images cannot contradict them. shown: [V], number of views of each vertex.
TriangleMesh without_ghosts(const TriangleMesh& mesh, const at::Tensor& shown, double fewest);

/// Simplifies to about `triangles` triangles at most (meshoptimizer's quadric simplifier), and
/// removes unused vertices.
TriangleMesh simplified(const TriangleMesh& mesh, std::int64_t triangles);

/// Returns the enclosed volume of a closed mesh; negative if it is inside out.
double enclosed_volume(const TriangleMesh& mesh);

}  // namespace item3d
