// Surfaces of signed values on a lattice, differentiable: deep marching tetrahedra (Shen et al.
// 2021, "Deep Marching Tetrahedra: a Hybrid Representation for High-Resolution 3D Shape
// Synthesis").
#pragma once

#include "item3d/core/math.h"

#include <torch/types.h>

#include <array>
#include <cstdint>
#include <vector>

namespace item3d {

/// A box of cubes, each cut into six tetrahedra around its diagonal (Kuhn 1960), so that neighbours
/// agree on every face. Vertex (x, y, z) has the index (z * (cells.y + 1) + y) * (cells.x + 1) + x.
struct Lattice {
    Vec3 origin{0.0f};
    float cell = 1.0f;  ///< edge of a cube, world units
    std::array<int, 3> cells{1, 1, 1};

    std::int64_t vertex_count() const {
        return static_cast<std::int64_t>(cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1);
    }
    /// [V, 3].
    torch::Tensor vertices() const;
    /// Twice as many cells of half the edge over the same box.
    Lattice refined() const;
};

/// Values [V] of a lattice at the vertices of lattice.refined(), trilinear. Differentiable.
torch::Tensor refined_values(const torch::Tensor& values, const Lattice& lattice);

/// What follows from the signs alone.
struct MarchedTopology {
    /// [E, 2] int64: lattice vertices of edges that the surface crosses; the first is inside.
    /// Each crossed edge is there once: it is a vertex of the surface.
    torch::Tensor edges;
    /// [T, 3] int64 rows of `edges`, counter-clockwise from outside.
    torch::Tensor triangles;
};

/// Finds topologies of one lattice again and again; keeps memory for it.
class MarchingTetrahedra {
  public:
    explicit MarchingTetrahedra(const Lattice& lattice);
    const Lattice& lattice() const { return lattice_; }

    /// values [V] float32: below 0 is inside. The surface is closed unless it meets the box's
    /// border.
    MarchedTopology topology(const torch::Tensor& values);

  private:
    Lattice lattice_;
    std::vector<std::int32_t> edge_rows_;  ///< by lower vertex and direction; -1: not crossed
};

/// [E, 3]: where linear interpolation is 0 along each edge, of `vertices` [V, 3] (moved or not).
/// Differentiable in values and vertices.
torch::Tensor surface_points(const MarchedTopology& topology, const torch::Tensor& values,
                             const torch::Tensor& vertices);

/// nvdiffrec's regulariser (Munkberg et al. 2022, equation 2): cross entropy between the values at
/// both ends of each crossed edge and the other end's sign. It takes away sign changes that no
/// picture asks for. values in lattice cells.
torch::Tensor sign_change_loss(const MarchedTopology& topology, const torch::Tensor& values);

}  // namespace item3d
