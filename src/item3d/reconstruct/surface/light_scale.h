// The brightness and the tint of the light as a whole, which photographs leave open.
#pragma once

#include "item3d/reconstruct/surface/trainable_light.h"
#include "item3d/reconstruct/surface/view_render.h"
#include "item3d/render/prefilter/environment_light.h"
#include "item3d/tensors/tensor.h"

namespace item3d {

/// Photographs of a surface that does not mirror tell the product of light and base colour alone.
/// TrainableLight::log_scale() is that one direction of the optimisation: the radiance's factor, a
/// channel, of which the base colour has the reciprocal. Highlights tell it, since a dielectric
/// mirrors 4 % whatever its colour; where there are none, light_scale_loss() decides.
struct LightScaleWeights {
    /// Squared stops between 1 and what white paper reflects that faces the light's brightest side.
    /// Photographs are exposed so that white is just white: of the nine lights of the project's
    /// scenes and reference data the mean is 1.1, the spread half a stop.
    double exposure = 0.003;
    /// Squared distance from a grey light along blue and orange, as daylight varies.
    double warmth = 0.003;
    /// The same along green and magenta, as it hardly does.
    double green = 0.03;
    /// White is like paint: d^2 / (d^2 + 0.25^2), d the distance of the ninth decile of the view's
    /// base colour (luminance) from 0.88. What is far darker is let go (Geman and McClure 1987).
    double brightness = 0.003;
};

/// Sets the field's base colour gain to the reciprocal of the light's scale. Returns a factor [3]
/// of the base colour, which is 1 and has the reciprocal's gradient; see ViewRenderOptions.
at::Tensor balance_base_color(NeuralTexture& field, const TrainableLight& light);

/// The weighted sum; light: prefiltered from `trainable`, view: drawn in it. Its gradient reaches
/// log_scale() alone: neither the light's shape nor the materials change for it.
at::Tensor light_scale_loss(const TrainableLight& trainable, const EnvironmentLight& light,
                            const RenderedView& view, const LightScaleWeights& weights);

}  // namespace item3d
