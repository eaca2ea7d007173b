#include "item3d/reconstruct/surface/light_scale.h"

#include <cmath>

namespace item3d {

namespace {

constexpr double white = 0.88;  ///< base colour of white paint, 241 in sRGB
constexpr double far_from_white = 0.25;

at::Tensor luminance(const at::Tensor& color) {
    return (color * at::tensor({0.2126f, 0.7152f, 0.0722f})).sum(-1);
}

/// Returns the quantile `part` of `values` [N].
at::Tensor quantile(const at::Tensor& values, double part) {
    const auto last = static_cast<double>(values.size(0) - 1);
    return std::get<0>(values.kthvalue(static_cast<std::int64_t>(part * last) + 1));
}

/// Returns the radiance [3] of white paper that faces the brightest side: the mean over the
/// brightest 2 %.
at::Tensor brightest_side(const EnvironmentLight& light) {
    const at::Tensor diffuse = light.diffuse.reshape({-1, 3});
    const at::Tensor values = luminance(diffuse);
    return diffuse.index({values >= quantile(values, 0.98)}).mean(0);
}

}  // namespace

at::Tensor balance_base_color(NeuralTexture& field, const TrainableLight& light) {
    const at::Tensor& scale = light.log_scale();
    field->set_base_color_gain((-scale.detach()).exp());
    return (scale.detach() - scale).exp();
}

at::Tensor light_scale_loss(const TrainableLight& trainable, const EnvironmentLight& light,
                            const RenderedView& view, const LightScaleWeights& weights) {
    const at::Tensor change = trainable.log_scale() - trainable.log_scale().detach();  // 0
    const at::Tensor side = brightest_side(light).detach().clamp_min(1e-6f);
    // The loss uses the mean of the channels' changes, so that it changes all channels alike. With
    // luminance weights, green would change most.
    const at::Tensor stops = luminance(side).log2() + change.mean() / std::log(2.0);
    const at::Tensor channels = side.log() + change;
    const at::Tensor warmth = (channels[0] - channels[2]) / std::sqrt(2.0);
    const at::Tensor green = (2 * channels[1] - channels[0] - channels[2]) / std::sqrt(6.0);
    at::Tensor loss = weights.exposure * stops.square() + weights.warmth * warmth.square() +
                      weights.green * green.square();
    if (view.surface.count() > 0) {
        const at::Tensor decile = quantile(luminance(view.material.base_color.detach()), 0.9);
        const at::Tensor square = (decile * (-change.mean()).exp() - white).square();
        loss = loss + weights.brightness * square / (square + far_from_white * far_from_white);
    }
    return loss;
}

}  // namespace item3d
