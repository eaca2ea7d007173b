// Interface of differentiable surface extraction from signed values on a lattice.
#pragma once

#include "item3d/reconstruct/shape/clean_mesh.h"
#include "item3d/reconstruct/shape/lattice.h"
#include "item3d/tensors/tensor.h"

#include <memory>
#include <string>
#include <vector>

namespace item3d {

/// Extracted surface with gradients.
struct ExtractedSurface {
    at::Tensor positions;  ///< [V, 3]
    at::Tensor triangles;  ///< [T, 3] int64, counter-clockwise from outside
    /// [E, 2] int64: lattice vertices of the edges that the surface crosses, each once; the first
    /// is inside.
    at::Tensor edges;
    /// Scalar loss of the method itself (see FlexiCubes); undefined: none.
    at::Tensor regularizer;
};

/// Extractor of surfaces from one lattice. values [V] float32: below 0 is inside. vertices [V, 3]:
/// of the lattice, moved or not.
class SurfaceExtraction {
  public:
    virtual ~SurfaceExtraction() = default;

    /// Differentiable in values, vertices and weights(). Closed unless it meets the box's border.
    virtual ExtractedSurface extract(const at::Tensor& values, const at::Tensor& vertices) = 0;
    /// Returns the same surface without gradients, in as few triangles as the method needs; may be
    /// empty.
    virtual TriangleMesh mesh(const at::Tensor& values, const at::Tensor& vertices) = 0;
    /// Returns the method's learned parameters beside values and vertices; gradients may be sparse.
    virtual std::vector<at::Tensor> weights() const { return {}; }
};

/// Makes an extraction, "flexicubes" or "tetrahedra".
std::unique_ptr<SurfaceExtraction> make_extraction(const std::string& name, const Lattice& lattice);
std::vector<std::string> extraction_names();

/// Returns nvdiffrec's regulariser (Munkberg et al. 2022, equation 2): cross entropy between the
/// values at both ends of each crossed edge [E, 2] and the other end's sign. It removes sign
/// changes that no image supports. values in lattice cells.
at::Tensor sign_change_loss(const at::Tensor& edges, const at::Tensor& values);

}  // namespace item3d
