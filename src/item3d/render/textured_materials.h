// A model's own textures and factors, evaluated at surface points.
#pragma once

#include "item3d/render/shade.h"
#include "item3d/scene/model.h"

#include <memory>

namespace item3d {

/// The materials of a model as tensors. sRGB textures are decoded to linear values before
/// filtering.
class TexturedMaterials {
  public:
    explicit TexturedMaterials(const Model& model, at::Device device = at::kCPU);
    /// Returns the materials at the points of a surface. Applies each texture's wrap modes, and
    /// filters where the surface has UV footprints. Vertex colours multiply the base colour.
    /// `normal`, `emissive` and `alpha` are undefined where no material of the model has them;
    /// alpha of masked materials is 0 or 1.
    MaterialSample sample(const Surface& surface) const;
    /// True if any material is masked or blended.
    bool has_alpha() const;

  private:
    struct State;
    std::shared_ptr<const State> state_;
};

}  // namespace item3d
