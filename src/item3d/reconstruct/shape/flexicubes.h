// FlexiCubes, a method of differentiable surface extraction from signed values on a lattice (Shen
// et al. 2023, "Flexible Isosurface Extraction for Gradient-Based Mesh Optimization").
#pragma once

#include "item3d/reconstruct/shape/surface_extraction.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Topology of the extracted surface, which depends on the signs of the values alone. D is the
/// number of the surface's vertices, one for each loop of crossed edges in a cube (see DualCase). A
/// is the number of cubes with such loops, K the number of pairs of a loop and one of its edges,
/// and Q the number of lattice edges that the surface crosses. Each of these Q edges gives a
/// quadrilateral with one vertex in each of the four cubes around it.
struct DualTopology {
    at::Tensor cubes;    ///< [A] int64, ascending: (z * cells.y + y) * cells.x + x
    at::Tensor cube_of;  ///< [D] int64: index of the vertex's cube in `cubes`
    at::Tensor loop;     ///< [K] int64: vertex of the surface, ascending
    at::Tensor edge;     ///< [K] int64: edge within the cube, see cube_edge()
    at::Tensor corners;  ///< [K, 2] int64: corners at that edge's ends; the first is inside
    at::Tensor ends;     ///< [K, 2] int64: lattice vertices at these corners
    at::Tensor quads;    ///< [Q, 4] int64: vertices of the surface, counter-clockwise from outside
    at::Tensor quad_ends;  ///< [Q, 2] int64: ends of the lattice edge; the first is inside
};

/// FlexiCubes extraction. Each vertex lies inside a cube, at the weighted mean of the crossings on
/// the cube's edges. Two cubes that share a doubled face both use the turned case (see DualCase),
/// so that the surface is manifold for any signs.
class FlexiCubes : public SurfaceExtraction {
  public:
    explicit FlexiCubes(const Lattice& lattice);

    /// Splits each quadrilateral into four triangles around an added vertex. The added vertex's
    /// position depends on gamma, so that both diagonals have a gradient (section 4.4). The
    /// regulariser is L_dev (equation 8): the mean absolute deviation of a vertex's distances to
    /// its crossings, in cells.
    ExtractedSurface extract(const at::Tensor& values, const at::Tensor& vertices) override;
    /// Splits each quadrilateral into two triangles, along the diagonal whose ends have the larger
    /// product of gammas.
    TriangleMesh mesh(const at::Tensor& values, const at::Tensor& vertices) override;
    /// Returns the raw weights [cubes, 21]: alpha of the eight corners and beta of the twelve
    /// edges, later mapped to the range 0 to 2, and gamma, later mapped to 0 to 1. Their gradients
    /// are sparse.
    std::vector<at::Tensor> weights() const override { return {weights_}; }

    DualTopology topology(const at::Tensor& values);

  private:
    struct Vertices;
    Vertices dual_vertices(const DualTopology& topology, const at::Tensor& values,
                           const at::Tensor& vertices) const;

    Lattice lattice_;
    at::Tensor weights_;
    std::vector<std::int32_t>
        row_of_cube_;  ///< index in `cubes`; -1 if the surface does not cross the cube
};

}  // namespace item3d
