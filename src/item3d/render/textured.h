// A model's own textures and factors, evaluated at surface points.
#pragma once

#include "item3d/render/shade.h"
#include "item3d/scene/model.h"

#include <memory>
#include <optional>

namespace item3d {

/// Bilinear values [P, C] of a texture [H, W, C] at uv [P, 2], where (0, 0) is the top left corner
/// of the image as in glTF; differentiable in the texture and in uv.
torch::Tensor sample_texture(const torch::Tensor& texture, const torch::Tensor& uv,
                             Wrap wrap_u = Wrap::repeat, Wrap wrap_v = Wrap::repeat);

/// A texture and its mip levels, each the mean of two by two texels of the one before, down to one
/// texel; differentiable.
std::vector<torch::Tensor> texture_pyramid(const torch::Tensor& texture);

/// Anisotropic: up to eight trilinear lookups along the longer axis of each pixel's footprint
/// [P, 4] (Surface::uv_footprint); an undefined footprint takes the first level alone.
/// Differentiable in the levels and in uv.
torch::Tensor sample_texture(const std::vector<torch::Tensor>& levels, const torch::Tensor& uv,
                             const torch::Tensor& footprint, Wrap wrap_u = Wrap::repeat,
                             Wrap wrap_v = Wrap::repeat);

/// The materials of a model as tensors, textures linearised (sRGB decoded before filtering).
class TexturedMaterials {
  public:
    explicit TexturedMaterials(const Model& model, torch::Device device = torch::kCPU);
    /// With each texture's wrap modes, filtered where the surface has UV footprints. Vertex colours
    /// multiply the base colour. `normal`, `emissive` and `alpha` are undefined where no material
    /// of the model has such; alpha of masked materials is 0 or 1.
    MaterialSample sample(const Surface& surface) const;
    /// Whether any material is masked or blended.
    bool has_alpha() const;

  private:
    struct State;
    std::shared_ptr<const State> state_;
};

class Occlusion;

struct RenderOptions {
    int width = 512;
    int height = 512;
    /// Each pixel is the mean of samples x samples sub-pixels, on top of edge antialiasing.
    int supersampling = 2;
    /// Linear RGB behind the model; no value: transparent.
    std::optional<Vec3> background;
    ShadeOptions shade;
    /// Darkens what the model hides from the light (occlusion.h). Null: nothing.
    std::shared_ptr<const Occlusion> occlusion;
};

/// One picture a camera: [N, H, W, 4] linear radiance, premultiplied, with coverage in A (1 where a
/// background was given). For pictures of textured models; the edit's loop has its own path.
torch::Tensor render(const Geometry& geometry, const TexturedMaterials& materials,
                     const EnvironmentLight& light, const std::vector<Camera>& cameras,
                     const RenderOptions& options);

}  // namespace item3d
