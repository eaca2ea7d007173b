// Deep marching tetrahedra, a method of differentiable surface extraction from signed values on a
// lattice (Shen et al. 2021, "Deep Marching Tetrahedra: a Hybrid Representation for High-Resolution
// 3D Shape Synthesis").
#pragma once

#include "item3d/reconstruct/shape/surface_extraction.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Topology of the extracted surface, which depends on the signs of the values alone.
struct MarchedTopology {
    /// [E, 2] int64: ends (lattice vertices) of the edges that the surface crosses; the first end
    /// is inside. Each crossed edge occurs once and holds one vertex of the surface.
    at::Tensor edges;
    /// [T, 3] int64: indices into `edges`, counter-clockwise from outside.
    at::Tensor triangles;
};

/// Marching tetrahedra on a lattice of cubes. Each cube is split into six tetrahedra around its
/// diagonal (Kuhn 1960), so that neighbouring cubes split their common face alike. The object
/// reuses its memory between extractions from one lattice.
class MarchingTetrahedra : public SurfaceExtraction {
  public:
    explicit MarchingTetrahedra(const Lattice& lattice);

    ExtractedSurface extract(const at::Tensor& values, const at::Tensor& vertices) override;
    TriangleMesh mesh(const at::Tensor& values, const at::Tensor& vertices) override;

    /// Returns the topology for values [V] float32, negative inside. The surface is closed unless
    /// it meets the border of the lattice.
    MarchedTopology topology(const at::Tensor& values);

  private:
    Lattice lattice_;
    std::vector<std::int32_t> edge_rows_;  ///< row of an edge, by lower vertex and direction; or -1
};

/// Returns the vertices of the surface [E, 3]: the point of each edge where the linearly
/// interpolated value is 0. vertices [V, 3]: positions of the lattice vertices, with or without
/// offsets. Differentiable in values and vertices.
at::Tensor surface_points(const MarchedTopology& topology, const at::Tensor& values,
                          const at::Tensor& vertices);

}  // namespace item3d
