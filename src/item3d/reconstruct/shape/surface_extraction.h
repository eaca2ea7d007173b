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
    /// [E, 2] int64: ends (lattice vertices) of the edges that the surface crosses. Each edge
    /// occurs once. Its first end is inside.
    at::Tensor edges;
    /// Scalar loss that the extraction method defines (see FlexiCubes); undefined if it defines
    /// none.
    at::Tensor regularizer;
};

/// Extractor of surfaces from one lattice. values [V] float32: negative inside. vertices [V, 3]:
/// positions of the lattice vertices, with or without offsets.
class SurfaceExtraction {
  public:
    virtual ~SurfaceExtraction() = default;

    /// Returns the surface, differentiable in values, vertices and weights(). It is closed unless
    /// it meets the border of the lattice.
    virtual ExtractedSurface extract(const at::Tensor& values, const at::Tensor& vertices) = 0;
    /// Returns the same surface without gradients, in as few triangles as the method needs; may be
    /// empty.
    virtual TriangleMesh mesh(const at::Tensor& values, const at::Tensor& vertices) = 0;
    /// Returns the method's learned parameters other than values and vertices. Their gradients may
    /// be sparse.
    virtual std::vector<at::Tensor> weights() const { return {}; }
};

/// Makes an extraction, "flexicubes" or "tetrahedra".
std::unique_ptr<SurfaceExtraction> make_extraction(const std::string& name, const Lattice& lattice);
std::vector<std::string> extraction_names();

/// Returns nvdiffrec's regulariser (Munkberg et al. 2022, equation 2): for both ends of each
/// crossed edge [E, 2], the cross entropy between the value at this end and the sign at the
/// opposite end. It removes sign changes that no image supports. values: in units of lattice cells.
at::Tensor sign_change_loss(const at::Tensor& edges, const at::Tensor& values);

}  // namespace item3d
