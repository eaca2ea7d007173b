// Averages of materials over the texels of an atlas: of the source's materials, and of two neural
// textures. Internal to baking.
#pragma once

#include "item3d/field/bake/bake.h"

#include <functional>
#include <optional>
#include <vector>

namespace item3d {

/// Means over a texel's samples. The base colour is linear and includes vertex colours. The normal
/// is in tangent space and does not have unit length.
struct TexelMaterial {
    Vec3 base_color{0.0f};
    Vec3 orm{0.0f};
    Vec3 normal{0.0f};
    float alpha = 1.0f;
};

struct TexelValue {
    int x = 0, y = 0;
    TexelMaterial source, fitted, now;
    float weight = 1.0f;  ///< BakeScene::weight
};

/// The values of each texel that a bake needs in addition to base colour and orm of `fitted` and
/// `now`.
struct TexelNeeds {
    bool source = false;
    bool normals = false;  ///< normals, in the tangent space of the atlas
};

/// Evaluator of one texture set's triangles on a grid of width x height texels.
class TexelEvaluator {
  public:
    TexelEvaluator(const BakeScene& scene, const TextureSet& set, int width, int height,
                   int supersampling, TexelNeeds needs);

    /// Calls take(texels) with the covered texels of several rows at a time; if the scene is on the
    /// CPU, on several threads. on_progress(share), if not null, is called on one thread at a time.
    /// Throws Interrupted after Ctrl-C.
    void for_rows(NeuralTexture& fitted, NeuralTexture& now,
                  const std::function<void(const std::vector<TexelValue>&)>& take,
                  const std::function<void(double)>& on_progress = {}) const;

  private:
    std::vector<TexelValue> rows(int first, int last, NeuralTexture& fitted,
                                 NeuralTexture& now) const;
    int rows_at_once() const;
    TexelMaterial read(const float* row) const;
    /// Returns the material as [P, 10] on the CPU. rotation: [P, 3, 3], applied to the normals; may
    /// be undefined.
    at::Tensor pack(const MaterialSample& sample, const at::Tensor& rotation) const;
    at::Tensor frame_change(const Surface& surface, const at::Tensor& triangle,
                            const at::Tensor& barycentrics) const;

    const BakeScene& scene_;
    int width_, height_, samples_;
    TexelNeeds needs_;
    std::vector<UvTriangle> triangles_;
    /// The model's triangle for each element of triangles_.
    const std::vector<std::int32_t>& model_triangles_;
    UvRaster raster_;
    /// Geometry with the atlas's UVs and the tangents that belong to them. No value if the source's
    /// normals need no change of tangent space.
    std::optional<Geometry> atlas_geometry_;
};

}  // namespace item3d
