// FlexiCubes, differentiable and flexible surface extraction from signed values on a lattice (Shen
// et al. 2023, "Flexible Isosurface Extraction for Gradient-Based Mesh Optimization").
#pragma once

#include "item3d/reconstruct/shape/surface_extraction.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Topology that follows from the signs alone. D vertices of the surface, one for each loop in
/// which it crosses a cube's edges; A cubes with such loops; K pairs of a loop and an edge that it
/// crosses; Q lattice edges that the surface crosses, each a quadrilateral of the four cubes around
/// it.
struct DualTopology {
    at::Tensor cubes;      ///< [A] int64, ascending: (z * cells.y + y) * cells.x + x
    at::Tensor cube_of;    ///< [D] int64 rows of `cubes`
    at::Tensor loop;       ///< [K] int64: vertex of the surface, ascending
    at::Tensor edge;       ///< [K] int64: edge of its cube, see cube_edge()
    at::Tensor corners;    ///< [K, 2] int64: ends of that edge in its cube; the first is inside
    at::Tensor ends;       ///< [K, 2] int64: those corners' lattice vertices
    at::Tensor quads;      ///< [Q, 4] int64 of D, counter-clockwise from outside
    at::Tensor quad_ends;  ///< [Q, 2] int64: the lattice edge; the first is inside
};

/// FlexiCubes extraction. Each vertex lies inside a cube, at the weighted mean of the crossings on
/// the cube's edges. If cubes that share a doubled face are both turned (see DualCase), the surface
/// is manifold for any signs.
class FlexiCubes : public SurfaceExtraction {
  public:
    explicit FlexiCubes(const Lattice& lattice);

    /// Splits each quadrilateral into four triangles around a vertex that moves with gamma, so that
    /// both diagonals have a gradient (section 4.4). The regulariser is L_dev (equation 8): mean
    /// absolute deviation of the distances, in cells, of a vertex from its crossings.
    ExtractedSurface extract(const at::Tensor& values, const at::Tensor& vertices) override;
    /// Splits each quadrilateral into two triangles, along the diagonal of the larger gammas.
    TriangleMesh mesh(const at::Tensor& values, const at::Tensor& vertices) override;
    /// Raw weights [cubes, 21], before mapping to their ranges: alpha of the eight corners and beta
    /// of the twelve edges (0 to 2), gamma (0 to 1). Sparse gradients.
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
