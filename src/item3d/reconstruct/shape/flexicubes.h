// Surfaces of signed values on a lattice, differentiable and flexible: FlexiCubes (Shen et al.
// 2023, "Flexible Isosurface Extraction for Gradient-Based Mesh Optimization").
#pragma once

#include "item3d/reconstruct/shape/surface_extraction.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// What follows from the signs alone. D vertices of the surface, each for a loop in which it
/// crosses a cube's edges; A cubes with such loops; K pairs of a loop and an edge that it crosses;
/// Q lattice edges that the surface crosses, each a quadrilateral of the four cubes around it.
struct DualTopology {
    at::Tensor cubes;      ///< [A] int64, rising: (z * cells.y + y) * cells.x + x
    at::Tensor cube_of;    ///< [D] int64 rows of `cubes`
    at::Tensor loop;       ///< [K] int64: vertex of the surface, rising
    at::Tensor edge;       ///< [K] int64: of its cube, see cube_edge()
    at::Tensor corners;    ///< [K, 2] int64: ends of that edge in its cube; the first is inside
    at::Tensor ends;       ///< [K, 2] int64: those corners' lattice vertices
    at::Tensor quads;      ///< [Q, 4] int64 of D, counter-clockwise from outside
    at::Tensor quad_ends;  ///< [Q, 2] int64: the lattice edge; the first is inside
};

/// A vertex lies inside a cube, at the weighted mean of where the surface crosses the cube's edges.
/// With cubes that meet at a face that is crossed twice in both turned alike (see DualCase), the
/// surface is a manifold for any signs.
class FlexiCubes : public SurfaceExtraction {
  public:
    explicit FlexiCubes(const Lattice& lattice);

    /// Quadrilaterals are cut into four triangles around a vertex that moves with gamma, so that
    /// both diagonals have a gradient (section 4.4). The regulariser is L_dev (equation 8): mean
    /// absolute deviation of the distances, in cells, of a vertex from its crossings.
    ExtractedSurface extract(const at::Tensor& values, const at::Tensor& vertices) override;
    /// Two triangles each, cut along the diagonal of the larger gammas.
    TriangleMesh mesh(const at::Tensor& values, const at::Tensor& vertices) override;
    /// [cubes, 21], before they are brought to their ranges: alpha of the eight corners and beta of
    /// the twelve edges (0 to 2), gamma (0 to 1). Sparse gradients.
    std::vector<at::Tensor> weights() const override { return {weights_}; }

    DualTopology topology(const at::Tensor& values);

  private:
    struct Vertices;
    Vertices dual_vertices(const DualTopology& topology, const at::Tensor& values,
                           const at::Tensor& vertices) const;

    Lattice lattice_;
    at::Tensor weights_;
    std::vector<std::int32_t> row_of_cube_;  ///< in `cubes`; -1: not crossed
};

}  // namespace item3d
