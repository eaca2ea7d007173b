// Scale of the light: its overall brightness and tint, which photographs leave undetermined.
#pragma once

#include "item3d/reconstruct/surface/trainable_light.h"
#include "item3d/reconstruct/surface/view_render.h"
#include "item3d/render/prefilter/environment_light.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Weights of the priors on the light's scale. Photographs of a surface without reflections
/// determine only the product of light and base colour. TrainableLight::log_scale() is that one
/// direction of the optimisation: the radiance's factor per channel, whose reciprocal multiplies
/// the base colour. Highlights determine it, since a dielectric reflects 4 % in any colour; without
/// them, light_scale_loss() decides.
struct LightScaleWeights {
    /// Squared stops between 1 and the radiance of white paper that faces the light's brightest
    /// side. Photographs are exposed so that white is just white: over the nine lights of the
    /// project's scenes and reference data the mean is 1.1, the spread half a stop.
    double exposure = 0.003;
    /// Squared distance from a grey light along blue and orange, in which daylight varies.
    double warmth = 0.003;
    /// Squared distance along green and magenta, in which daylight hardly varies.
    double green = 0.03;
    /// Paint-like white: d^2 / (d^2 + 0.25^2), d the distance of the ninth decile of the view's
    /// base colour (luminance) from 0.88. Far darker values have no pull (Geman and McClure 1987).
    double brightness = 0.003;
};

/// Sets the field's base colour gain to the reciprocal of the light's scale. Returns a factor [3]
/// of the base colour for ViewRenderOptions. Its value is 1, and its gradient is that of the
/// reciprocal.
at::Tensor balance_base_color(NeuralTexture& field, const TrainableLight& light);

/// Returns the weighted sum; light: prefiltered from `trainable`, view: rendered in it. The
/// gradient reaches log_scale() alone: neither the light's shape nor the materials change.
at::Tensor light_scale_loss(const TrainableLight& trainable, const EnvironmentLight& light,
                            const RenderedView& view, const LightScaleWeights& weights);

}  // namespace item3d
