// The unknown light that the photographs were taken in.
#pragma once

#include "item3d/render/environment_light.h"
#include "item3d/scene/image.h"

#include <torch/types.h>

namespace item3d {

/// An equirectangular map whose texels are optimised: their logarithms, so that radiance stays
/// above 0 and a sun of a thousand times the sky's radiance is as easily found as the sky.
class TrainableLight {
  public:
    /// Grey of the given radiance from everywhere; `height` rows of twice as many texels.
    explicit TrainableLight(int height = 64, float radiance = 0.5f);

    /// The parameter: [H, 2H, 3] log radiance; requires gradients.
    torch::Tensor& logarithm() { return logarithm_; }
    torch::Tensor radiance() const { return logarithm_.exp(); }
    /// Differentiable, with a cube of `height` texels a side.
    EnvironmentLight prefiltered() const;
    Image to_image() const;

    /// Mean distance of the texels' channels from their mean, by solid angle (nvdiffrec's
    /// regulariser: of all lights that explain the pictures, the whitest).
    torch::Tensor whiteness_loss() const;

  private:
    torch::Tensor logarithm_;
    torch::Tensor solid_angle_;  ///< [H, 1, 1], sums to 1 over all texels
};

}  // namespace item3d
