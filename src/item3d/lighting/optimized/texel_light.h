// ITEM3D's own way: every texel of the environment by itself.
#pragma once

#include "item3d/lighting/optimized/light_model.h"

namespace item3d {

/// A light multiplied, texel by texel and channel by channel, by exp(r): positive whatever r is,
/// and a stop is as far for a sun as for a shadow. r is a map of 32 x 64 texels, read bilinearly,
/// so that it shades what the light has and draws nothing sharp of its own.
///
/// The regularisation holds r smooth, near 0, near the Planckian locus (light is seldom green or
/// magenta), and free of the object's colour: a red mug on its way to "at night" is not to be
/// darkened by a light that has lost its red.
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
    at::Tensor solid_angles_;      ///< [1, 1, 32, 1], their mean is 1
    at::Tensor object_direction_;  ///< [1, 3, 1, 1] of the object's colour in log RGB, unit
    float object_chroma_ = 0;      ///< how coloured it is, 0 .. 1
};

}  // namespace item3d
