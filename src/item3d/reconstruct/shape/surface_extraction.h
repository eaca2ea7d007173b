// From signed values on a lattice to triangles, differentiable: what the two ways share.
#pragma once

#include "item3d/reconstruct/shape/clean_mesh.h"
#include "item3d/reconstruct/shape/lattice.h"
#include "item3d/tensors/tensor.h"

#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// As the optimisation wants it.
struct ExtractedSurface {
    at::Tensor positions;  ///< [V, 3]
    at::Tensor triangles;  ///< [T, 3] int64, counter-clockwise from outside
    /// [E, 2] int64: lattice vertices of edges that the surface crosses, each once; the first is
    /// inside.
    at::Tensor edges;
    /// Scalar, what the way itself asks for (see FlexiCubes); undefined: nothing.
    at::Tensor regularizer;
};

/// One lattice's surfaces, again and again. values [V] float32: below 0 is inside. vertices [V, 3]:
/// of the lattice, moved or not.
class SurfaceExtraction {
  public:
    virtual ~SurfaceExtraction() = default;

    /// Differentiable in values, vertices and weights(). Closed unless it meets the box's border.
    virtual ExtractedSurface extract(const at::Tensor& values, const at::Tensor& vertices) = 0;
    /// The same surface with as many triangles as it takes, without gradients; may be empty.
    virtual TriangleMesh mesh(const at::Tensor& values, const at::Tensor& vertices) = 0;
    /// What it learns beside values and vertices; gradients may be sparse.
    virtual std::vector<at::Tensor> weights() const { return {}; }
};

/// "flexicubes" or "tetrahedra".
std::unique_ptr<SurfaceExtraction> make_extraction(const std::string& name, const Lattice& lattice);
std::vector<std::string> extraction_names();

/// nvdiffrec's regulariser (Munkberg et al. 2022, equation 2): cross entropy between the values at
/// both ends of each crossed edge [E, 2] and the other end's sign. It takes away sign changes that
/// no picture asks for. values in lattice cells.
at::Tensor sign_change_loss(const at::Tensor& edges, const at::Tensor& values);

}  // namespace item3d
