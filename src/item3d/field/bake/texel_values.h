// Materials averaged over the texels of an atlas: the source's, and those of two neural textures.
// Internal to baking.
#pragma once

#include "item3d/field/bake/bake.h"

#include <optional>
#include <vector>

namespace item3d {

/// Averages over a texel's samples: linear base colour (vertex colours included), orm,
/// tangent-space normal (not unit), alpha.
struct TexelMaterial {
    Vec3 base_color{0.0f};
    Vec3 orm{0.0f};
    Vec3 normal{0.0f};
    float alpha = 1.0f;
};

struct TexelValue {
    int x = 0, y = 0;
    TexelMaterial source, fitted, now;
};

/// Samples of one material's triangles on a grid of width x height texels.
class TexelEvaluator {
  public:
    /// needs_normals: normals are to be in the tangent space of the atlas.
    TexelEvaluator(const BakeScene& scene, int material, int width, int height, int supersampling,
                   bool needs_normals);

    /// The covered texels of rows [first, last).
    std::vector<TexelValue> rows(int first, int last, NeuralTexture& fitted,
                                 NeuralTexture& now) const;
    /// Rows that make a batch of reasonable size.
    int rows_at_once() const;

  private:
    TexelMaterial read(const float* row) const;
    /// [P, 10] on the CPU, of a sample at `surface`; rotation [P, 3, 3] or undefined goes to the
    /// normals.
    at::Tensor pack(const MaterialSample& sample, const at::Tensor& rotation) const;
    at::Tensor frame_change(const Surface& surface, const at::Tensor& triangle,
                            const at::Tensor& barycentrics) const;

    const BakeScene& scene_;
    int width_, height_, samples_;
    std::vector<UvTriangle> triangles_;
    const std::vector<std::int32_t>& model_triangles_;  ///< of each of triangles_
    UvRaster raster_;
    /// The model with the atlas's UVs, for its tangents; where they differ from the source's.
    std::optional<Geometry> atlas_geometry_;
};

}  // namespace item3d
