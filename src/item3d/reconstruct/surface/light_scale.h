// Scale of the light, that is, its overall brightness and tint. Photographs of surfaces without
// reflections do not determine it.
#pragma once

#include "item3d/reconstruct/surface/trainable_light.h"
#include "item3d/reconstruct/surface/view_render.h"
#include "item3d/render/prefilter/environment_light.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Weights of the priors on the light's scale. Photographs of a surface without reflections
/// determine only the product of light and base colour. TrainableLight::log_scale() is the
/// logarithm of one factor per channel. The factor multiplies the radiance, and its reciprocal
/// multiplies the base colour. Highlights determine the factor, because a dielectric reflects 4 %
/// in any colour. Without highlights, light_scale_loss() determines it.
struct LightScaleWeights {
    /// Weight of the squared difference, in stops, between 1 and the radiance of white paper that
    /// faces the light's brightest side. Photographs are exposed so that such paper is just white.
    /// Over the nine lights of the project's scenes and reference data, the paper's mean radiance
    /// is 1.1, with a spread of half a stop.
    double exposure = 0.003;
    /// Weight of the light's squared distance from grey along the axis from blue to orange.
    /// Daylight varies along this axis.
    double warmth = 0.003;
    /// Weight of the light's squared distance from grey along the axis from green to magenta.
    /// Daylight hardly varies along this axis.
    double green = 0.03;
    /// Weight of d^2 / (d^2 + 0.25^2), where d is the difference between 0.88, the base colour of
    /// white paint, and the ninth decile of the luminance of the view's base colour. If the decile
    /// is far below 0.88, this loss has almost no gradient (Geman and McClure 1987).
    double brightness = 0.003;
};

/// Sets the field's base colour gain to the reciprocal of the light's scale. Returns the factor [3]
/// for ViewRenderOptions::base_color_factor. The factor's value is 1, and its gradient is that of
/// the reciprocal divided by the reciprocal's current value.
at::Tensor balance_base_color(NeuralTexture& field, const TrainableLight& light);

/// Returns the weighted sum of the priors. light: prefiltered light of `trainable`. view: render in
/// this light. Only log_scale() gets a gradient; the other parameters of the light, and the
/// material field, get none.
at::Tensor light_scale_loss(const TrainableLight& trainable, const EnvironmentLight& light,
                            const RenderedView& view, const LightScaleWeights& weights);

}  // namespace item3d
