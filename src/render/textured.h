// A model's own textures and factors, evaluated at surface points.
#pragma once

#include "item3d/render/shade.h"
#include "item3d/scene/model.h"

namespace item3d {

/// The materials of a model as tensors, textures linearised (sRGB decoded before filtering).
class TexturedMaterials {
  public:
    explicit TexturedMaterials(const Model& model, torch::Device device = torch::kCPU);
    /// Bilinear, with each texture's wrap modes; differentiable in the textures where they require
    /// gradients. Vertex colours multiply the base colour.
    MaterialSample sample(const Surface& surface) const;

  private:
    struct State;
    std::shared_ptr<const State> state_;
};

struct RenderOptions {
    int width = 512;
    int height = 512;
    /// Each pixel is the mean of samples x samples sub-pixels, on top of edge antialiasing.
    int supersampling = 2;
    /// Linear RGB behind the model; no value: transparent.
    std::optional<Vec3> background;
};

/// One picture a camera: [N, H, W, 4] linear radiance, premultiplied, with coverage in A (1 where a
/// background was given). For pictures of textured models; the edit's loop has its own path.
torch::Tensor render(const Geometry& geometry, const TexturedMaterials& materials,
                     const EnvironmentLight& light, const std::vector<Camera>& cameras,
                     const RenderOptions& options);

}  // namespace item3d
