// Deep marching tetrahedra, differentiable surface extraction from signed values on a lattice (Shen
// et al. 2021, "Deep Marching Tetrahedra: a Hybrid Representation for High-Resolution 3D Shape
// Synthesis").
#pragma once

#include "item3d/reconstruct/shape/surface_extraction.h"

#include <cstdint>
#include <vector>

namespace item3d {

/// Topology that follows from the signs alone.
struct MarchedTopology {
    /// [E, 2] int64: lattice vertices of the edges that the surface crosses; the first is inside.
    /// Each crossed edge occurs once: it is a vertex of the surface.
    at::Tensor edges;
    /// [T, 3] int64 rows of `edges`, counter-clockwise from outside.
    at::Tensor triangles;
};

/// Marching tetrahedra on cubes, each split into six tetrahedra around its diagonal (Kuhn 1960), so
/// that neighbours agree on every face. Reuses its memory between extractions from one lattice.
class MarchingTetrahedra : public SurfaceExtraction {
  public:
    explicit MarchingTetrahedra(const Lattice& lattice);

    ExtractedSurface extract(const at::Tensor& values, const at::Tensor& vertices) override;
    TriangleMesh mesh(const at::Tensor& values, const at::Tensor& vertices) override;

    /// Returns the topology of values [V] float32: below 0 is inside. The surface is closed unless
    /// it meets the box's border.
    MarchedTopology topology(const at::Tensor& values);

  private:
    Lattice lattice_;
    std::vector<std::int32_t> edge_rows_;  ///< by lower vertex and direction; -1: not crossed
};

/// Returns the zero of linear interpolation along each edge, [E, 3], from `vertices` [V, 3] (moved
/// or not). Differentiable in values and vertices.
at::Tensor surface_points(const MarchedTopology& topology, const at::Tensor& values,
                          const at::Tensor& vertices);

}  // namespace item3d
