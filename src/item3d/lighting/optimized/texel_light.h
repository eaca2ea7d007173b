// The light of the ITEM3D paper: one parameter for each texel and channel.
#pragma once

#include "item3d/lighting/optimized/light_model.h"

namespace item3d {

/// The initial light multiplied by exp(r), where r has a value for each texel and channel. So the
/// light is always positive, and a step of r changes a sun and a shadow by the same factor. r is a
/// map of 32 x 64 texels, interpolated bilinearly, so that it scales the light's content and adds
/// no sharp features.
///
/// The regularisation keeps r smooth, near 0, near the Planckian locus (light is seldom green or
/// magenta), and independent of the object's colour: a red mug edited towards "at night" should not
/// be darkened by a light without red.
class TexelLight : public LightModel {
  public:
    TexelLight(const Image& light, const LightModelOptions& options);
    at::Tensor cube(int size) const override;
    Image image(int height) const override;
    at::Tensor regularization() const override;
    NamedTensors named_parameters() const override;

  private:
    at::Tensor radiance(int height) const;

    at::Tensor start_;             ///< [1, 3, H, W]
    at::Tensor change_;            ///< r, [1, 3, 32, 64]
    at::Tensor solid_angles_;      ///< [1, 1, 32, 1], of mean 1
    at::Tensor object_direction_;  ///< [1, 3, 1, 1] unit vector of the object's colour in log RGB
    float object_chroma_ = 0;      ///< saturation of that colour, 0 to 1
};

}  // namespace item3d
