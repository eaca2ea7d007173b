// Renders of a whole model from all around, for reports, scores and captions.
#pragma once

#include "item3d/render/textured_materials.h"
#include "item3d/scene/camera.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Returns `count` cameras around the model, slightly above it.
std::vector<Camera> image_cameras(const Model& model, int count, float first_azimuth = 0);

/// Returns the edge length, in texels, of the light's cube map for images of `pixels` x `pixels`.
int light_texels(int pixels);

/// Model prepared for repeated rendering.
class ModelDrawing {
  public:
    ModelDrawing(const Model& model, EnvironmentLight light);

    /// Renders premultiplied linear radiance [N, pixels, pixels, 4] on the light's device. Renders
    /// one view at a time to keep memory low.
    at::Tensor draw(const std::vector<Camera>& cameras, int pixels) const;

  private:
    EnvironmentLight light_;
    Geometry geometry_;
    TexturedMaterials materials_;
};

/// Calls ModelDrawing::draw() once.
at::Tensor draw_images(const Model& model, const EnvironmentLight& light,
                       const std::vector<Camera>& cameras, int pixels);

/// Composites images of ModelDrawing::draw() over white. Returns sRGB [N, 3, H, W] in [0, 1].
at::Tensor over_white(const at::Tensor& linear);

/// Returns the detail_correlation() of two sets of ModelDrawing::draw() images. The mask is the
/// model's coverage in the first set.
double detail_kept(const at::Tensor& before, const at::Tensor& after);

}  // namespace item3d
