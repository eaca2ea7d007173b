// Cubic lattice of the signed values.
#pragma once

#include "item3d/core/math.h"
#include "item3d/tensors/tensor.h"

#include <array>
#include <cstdint>

namespace item3d {

/// Box of cubes. Vertex (x, y, z) has the index (z * (cells.y + 1) + y) * (cells.x + 1) + x.
struct Lattice {
    Vec3 origin{0.0f};
    float cell = 1.0f;  ///< edge of a cube, in world units
    std::array<int, 3> cells{1, 1, 1};

    std::int64_t vertex_count() const {
        return static_cast<std::int64_t>(cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1);
    }
    /// Returns the vertices' positions [V, 3].
    at::Tensor vertices() const;
    /// Returns a lattice of the same box with twice as many cells along each axis.
    Lattice refined() const;
};

/// Returns the values [V] of a lattice, interpolated trilinearly at the vertices of
/// lattice.refined(). Differentiable.
at::Tensor refined_values(const at::Tensor& values, const Lattice& lattice);

}  // namespace item3d
