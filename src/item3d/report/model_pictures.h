// Pictures of a whole model from all around, for reports, scores and captions.
#pragma once

#include "item3d/render/textured_materials.h"
#include "item3d/scene/camera.h"
#include "item3d/scene/model.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// `count` cameras around the model, a little above it.
std::vector<Camera> picture_cameras(const Model& model, int count, float first_azimuth = 0);

/// Texels along the edge of a light's cube that pictures of `pixels` x `pixels` are drawn with.
int light_texels(int pixels);

/// A model made ready to be drawn, for who draws it again and again.
class ModelDrawing {
  public:
    ModelDrawing(const Model& model, EnvironmentLight light);

    /// [N, pixels, pixels, 4] linear radiance, premultiplied, on the light's device; one view at a
    /// time to keep memory low.
    at::Tensor draw(const std::vector<Camera>& cameras, int pixels) const;

  private:
    EnvironmentLight light_;
    Geometry geometry_;
    TexturedMaterials materials_;
};

/// ModelDrawing::draw() once.
at::Tensor draw_pictures(const Model& model, const EnvironmentLight& light,
                         const std::vector<Camera>& cameras, int pixels);

/// Those over white: [N, 3, H, W] sRGB in [0, 1].
at::Tensor over_white(const at::Tensor& linear);

/// detail_correlation (detail.h) of two such sets of pictures, where the first shows the model.
double detail_kept(const at::Tensor& before, const at::Tensor& after);

}  // namespace item3d
