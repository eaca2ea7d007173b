// A mesh as it comes from a lattice, made fit for textures.
#pragma once

#include "item3d/tensors/tensor.h"

#include <cstdint>

namespace item3d {

struct TriangleMesh {
    at::Tensor positions;  ///< [V, 3] float32
    at::Tensor triangles;  ///< [T, 3] int64
};

/// Only connected parts with at least `share` of the largest one's area: specks in corners that few
/// pictures see go.
TriangleMesh without_specks(const TriangleMesh& mesh, double share = 0.02);

/// Parts besides the largest go whose vertices have less than `fewest` on average: what few
/// pictures show, none of them can contradict. shown: [V], how many do.
TriangleMesh without_ghosts(const TriangleMesh& mesh, const at::Tensor& shown, double fewest);

/// At most about `triangles` triangles (meshoptimizer's quadric simplifier), and no vertex that is
/// not used.
TriangleMesh simplified(const TriangleMesh& mesh, std::int64_t triangles);

/// Enclosed volume of a closed mesh; below 0 when it is inside out.
double enclosed_volume(const TriangleMesh& mesh);

}  // namespace item3d
