// Tests of the losses that determine the brightness of a light.
#include "item3d/reconstruct/surface/light_scale.h"

#include "item3d/reconstruct/surface/appearance.h"
#include "item3d/scene/sphere.h"
#include "tests/support/reconstruct.h"

#include <cmath>

namespace item3d {
namespace {

class LightScale : public ::testing::Test {
  protected:
    LightScale() { fit_depth_range(view_.camera, model_.bounds()); }

    void scale_by(const std::vector<float>& logarithms) {
        const at::NoGradGuard no_gradient;
        appearance_.light.log_scale().add_(at::tensor(logarithms));
    }

    RenderedView render(const EnvironmentLight& light) {
        const at::Tensor factor = balance_base_color(appearance_.field, appearance_.light);
        return render_view(geometry_, appearance_.field, light, view_,
                           {.base_color_factor = factor});
    }

    at::Tensor loss(const LightScaleWeights& weights) {
        const EnvironmentLight light = appearance_.light.prefiltered();
        return light_scale_loss(appearance_.light, light, render(light), weights);
    }

    /// Returns the derivative of `value` along a direction of log_scale(), by finite differences.
    template <typename Value>
    double slope(const std::vector<float>& direction, const Value& value) {
        constexpr float step = 0.02f;
        std::vector<float> there, back;
        for (const float d : direction) {
            there.push_back(step * d);
            back.push_back(-2 * step * d);
        }
        scale_by(there);
        const double above = value().template item<double>();
        scale_by(back);
        const double below = value().template item<double>();
        scale_by(there);
        return (above - below) / (2 * step);
    }

    double learned_slope(const std::vector<float>& direction) const {
        return (appearance_.light.log_scale().grad() * at::tensor(direction)).sum().item<double>();
    }

    Model model_ = make_unit_sphere(24, 32);
    Geometry geometry_ = Geometry::from_model(model_);
    TargetView view_{"view", testing::ring_of_cameras(1).front(), at::zeros({1, 24, 24, 4})};
    Appearance appearance_ = make_appearance(model_.bounds(), {view_}, AppearanceStart::matt, 0);
};

const std::vector<float> grey{1, 1, 1}, warm{1, 0, -1}, green{-1, 2, -1};

TEST_F(LightScale, ImagesChangeWithItAsTheirGradientSays) {
    at::manual_seed(5);
    const at::Tensor weight = at::rand({1, 24, 24, 4});
    const auto value = [&] {
        return (render(appearance_.light.prefiltered()).image * weight).sum();
    };
    value().backward();
    const at::Tensor learned = appearance_.light.log_scale().grad();
    for (const auto& direction : {grey, warm, green})
        EXPECT_NEAR(slope(direction, value), learned_slope(direction),
                    0.02 * learned.abs().max().item<double>());
    // The base colour compensates for the light, so only reflections contribute to the slope.
    const double alone = (value().item<double>() - weight.select(3, 3).sum().item<double>());
    EXPECT_LT(std::abs(learned_slope(grey)), 0.5 * std::abs(alone));
}

TEST_F(LightScale, EachTermIsAsItsFormulaHasIt) {
    const LightScaleWeights exposure{.exposure = 1, .warmth = 0, .green = 0, .brightness = 0};
    const LightScaleWeights warmth{.exposure = 0, .warmth = 1, .green = 0, .brightness = 0};
    const LightScaleWeights tint{.exposure = 0, .warmth = 0, .green = 1, .brightness = 0};
    // At the start, the light is 0.7 in all directions.
    EXPECT_NEAR(loss(exposure).item<double>(), std::pow(std::log2(0.7), 2), 1e-3);
    EXPECT_NEAR(loss(warmth).item<double>(), 0, 1e-6);
    scale_by({0.3f, 0.0f, -0.3f});
    EXPECT_NEAR(loss(warmth).item<double>(), 0.18, 1e-3);
    EXPECT_NEAR(loss(tint).item<double>(), 0, 1e-6);
    scale_by({-0.3f, 0.3f, 0.3f});
    EXPECT_NEAR(loss(tint).item<double>(), 0.06, 1e-3);
}

TEST_F(LightScale, GradientsOfTheTermsMatchFiniteDifferencesAndReachNothingElse) {
    scale_by({0.2f, -0.1f, 0.1f});
    const std::vector<std::pair<LightScaleWeights, std::vector<float>>> cases{
        {{.exposure = 1, .warmth = 0, .green = 0, .brightness = 0}, grey},
        {{.exposure = 0, .warmth = 1, .green = 0, .brightness = 0}, warm},
        {{.exposure = 0, .warmth = 0, .green = 1, .brightness = 0}, green},
        {{.exposure = 0, .warmth = 0, .green = 0, .brightness = 1}, grey}};
    for (const auto& [weights, direction] : cases) {
        appearance_.light.log_scale().mutable_grad() = at::Tensor();
        loss(weights).backward();
        const double wanted = slope(direction, [&] { return loss(weights); });
        EXPECT_GT(std::abs(wanted), 0.05);
        EXPECT_NEAR(learned_slope(direction), wanted, 0.02 * std::abs(wanted));
    }
    for (const at::Tensor& level : appearance_.light.parameters())
        EXPECT_FALSE(level.grad().defined());
    for (const at::Tensor& parameter : appearance_.field->network_parameters())
        EXPECT_FALSE(parameter.grad().defined());
}

TEST_F(LightScale, DarkAndRoughMetalsBecomeDielectrics) {
    RenderedView view = render(appearance_.light.prefiltered());
    const std::int64_t rows = view.surface.count();
    at::Tensor metallic = at::ones({rows}).set_requires_grad(true);
    const auto set = [&](float base_color, float roughness) {
        view.material.base_color = at::full({rows, 3}, base_color);
        view.material.orm = at::stack({at::ones({rows}), at::full({rows}, roughness), metallic}, 1);
    };
    set(0.6f, 0.6f);
    EXPECT_NEAR(dark_metal_loss(view).item<double>(), 0, 1e-7);
    EXPECT_NEAR(rough_metal_loss(view).item<double>(), 0, 1e-7);
    set(0.1f, 0.8f);
    for (const auto& [loss, wanted] :
         {std::pair{dark_metal_loss(view), 0.4}, std::pair{rough_metal_loss(view), 0.1}}) {
        EXPECT_NEAR(loss.item<double>(), wanted, 1e-6);
        metallic.mutable_grad() = at::Tensor();
        loss.backward();
        EXPECT_GT(metallic.grad().min().item<float>(), 0);
    }
}

}  // namespace
}  // namespace item3d
