// Unknown light of the photographs.
#pragma once

#include "item3d/render/prefilter/environment_light.h"
#include "item3d/scene/image.h"
#include "item3d/tensors/tensor.h"

#include <vector>

namespace item3d {

/// Light as an equirectangular map. The logarithms of its texels are optimised, so that radiance
/// stays positive and a sun of a thousand times the sky's radiance is found as easily as the sky.
/// The logarithm is a sum of maps, each of twice the size of the one before, up to `height` rows.
/// The optimisation can therefore brighten half the sky as fast as a single texel.
class TrainableLight {
  public:
    /// Starts from uniform grey of the given radiance. height: number of rows of the map, a power
    /// of two of at least 16.
    explicit TrainableLight(int height, float radiance = 0.7f);

    /// Returns the maps, [h, 2h, 3] each. They require gradients.
    const std::vector<at::Tensor>& parameters() const { return levels_; }
    /// Returns the logarithm [3] of a factor of all radiance, see light_scale.h. It is 0 initially,
    /// and requires a gradient.
    const at::Tensor& log_scale() const { return log_scale_; }
    /// Returns the radiance, [H, 2H, 3].
    at::Tensor radiance() const;
    /// Returns the prefiltered light, differentiable, with a cube of `height` texels along an edge.
    EnvironmentLight prefiltered() const;
    Image to_image() const;

    /// Returns the mean distance of a texel's channels from their mean, with texels weighted by
    /// solid angle. It is nvdiffrec's regulariser, which prefers the whitest light that explains
    /// the images. No gradient reaches log_scale().
    at::Tensor whiteness_loss() const;
    /// Sets the gradients of each texel's channels to their mean, so that the light learns no
    /// colour.
    void take_color_from_gradients();

  private:
    int height_;
    std::vector<at::Tensor> levels_;
    at::Tensor log_scale_;
    at::Tensor solid_angle_;  ///< [H, 1, 1], sums to 1 over all texels
};

}  // namespace item3d
