// The unknown light that the photographs were taken in.
#pragma once

#include "item3d/render/prefilter/environment_light.h"
#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// An equirectangular map whose texels are optimised: their logarithms, so that radiance stays
/// above 0 and a sun of a thousand times the sky's radiance is as easily found as the sky. The
/// logarithm is a sum of maps, each of twice the size of the one before, up to `height` rows: half
/// the sky brightens as fast as one texel does.
class TrainableLight {
  public:
    /// Grey of the given radiance from everywhere; height: a power of two, at least 16.
    explicit TrainableLight(int height, float radiance = 0.7f);

    /// [h, 2h, 3] each; they require gradients.
    const std::vector<at::Tensor>& parameters() const { return levels_; }
    /// The logarithm of a factor of all radiance, [3], beginning at 0; requires a gradient. See
    /// light_scale.h.
    const at::Tensor& log_scale() const { return log_scale_; }
    /// [H, 2H, 3].
    at::Tensor radiance() const;
    /// Differentiable, with a cube of `height` texels a side.
    EnvironmentLight prefiltered() const;
    Image to_image() const;

    /// Mean distance of the texels' channels from their mean, by solid angle (nvdiffrec's
    /// regulariser: of all lights that explain the pictures, the whitest). No gradient reaches
    /// log_scale().
    at::Tensor whiteness_loss() const;
    /// Sets the gradients of each texel's channels to their mean: the light learns no colour.
    void take_color_from_gradients();

  private:
    int height_;
    std::vector<at::Tensor> levels_;
    at::Tensor log_scale_;
    at::Tensor solid_angle_;  ///< [H, 1, 1], sums to 1 over all texels
};

}  // namespace item3d
