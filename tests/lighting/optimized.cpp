// Tests of optimised lights: initial values, physical validity, and gradients.
#include "item3d/core/error.h"
#include "item3d/lighting/environment.h"
#include "item3d/lighting/optimized/physical_light.h"
#include "item3d/lighting/optimized/texel_light.h"

#include <gtest/gtest.h>

#include <cmath>

namespace item3d {
namespace {

std::unique_ptr<LightModel> begin(LightKind kind, const std::string& preset,
                                  std::optional<SkyAngles> from = std::nullopt) {
    LightModelOptions options;
    options.kind = kind;
    options.from = from;
    options.object_color = Vec3(0.7f, 0.1f, 0.1f);
    return make_light_model(make_light_preset(preset, 64), options);
}

float angle_between(const SkyAngles& a, const SkyAngles& b) {
    const float cosine = glm::dot(to_direction(a), to_direction(b));
    return std::acos(std::min(1.0f, cosine)) * 180 / pi;
}

TEST(LightModels, BeginAtTheLightThatWasGiven) {
    for (const char* preset : {"studio", "sunset", "noon"}) {
        const Image light = make_light_preset(preset, 64);
        const LightDescription wanted = describe_light(light);
        EXPECT_EQ(begin(LightKind::texels, preset)->image(64).pixels.size(), light.pixels.size());
        const LightDescription texels = describe_light(begin(LightKind::texels, preset)->image(64));
        EXPECT_NEAR(texels.peak_irradiance_over_pi, wanted.peak_irradiance_over_pi, 1e-3);
        const LightDescription physical =
            describe_light(begin(LightKind::physical, preset)->image(64));
        EXPECT_NEAR(physical.peak_irradiance_over_pi / wanted.peak_irradiance_over_pi, 1, 0.35)
            << preset;
        // A sunset's colours are not those of a black body. The physical light's colours are, so
        // its temperature is 3900 K instead of 3300 K.
        EXPECT_NEAR(*physical.color_temperature / *wanted.color_temperature, 1, 0.25) << preset;
    }
}

TEST(LightModels, ComeFromWhereWordsSay) {
    for (const SkyAngles from :
         {SkyAngles{10, 5}, SkyAngles{235, 25}, SkyAngles{100, 90}, SkyAngles{325, -35}}) {
        for (const LightKind kind : {LightKind::physical, LightKind::texels}) {
            const LightDescription light = describe_light(begin(kind, "studio", from)->image(128));
            EXPECT_LT(angle_between(to_sky_angles(light.lobe.direction), from), 3)
                << static_cast<int>(kind);
        }
    }
}

TEST(LightModels, StayPositiveAndFiniteFarFromTheirStart) {
    for (const LightKind kind : {LightKind::physical, LightKind::texels}) {
        for (const float far : {-8.0f, 8.0f}) {
            const auto light = begin(kind, "studio");
            const at::NoGradGuard no_grad;
            for (at::Tensor parameter : light->parameters())
                parameter.fill_(far);
            const at::Tensor cube = light->cube(16);
            EXPECT_TRUE(at::isfinite(cube).all().item<bool>()) << static_cast<int>(kind);
            EXPECT_GE(cube.min().item<float>(), 0) << static_cast<int>(kind);
            EXPECT_GT(cube.max().item<float>(), 0) << static_cast<int>(kind);
        }
    }
}

TEST(LightModels, MeanOfTheSphereIsTheSameInCubeAndMap) {
    const auto light = begin(LightKind::physical, "noon");
    const float cube = light->cube(64).mean().item<float>();
    const Image map = light->image(128);
    const glm::dvec3 mean = mean_radiance(map);
    // Texels at a cube's corners are smaller, so its plain mean differs somewhat.
    EXPECT_NEAR(cube / ((mean.x + mean.y + mean.z) / 3), 1, 0.35);
}

TEST(LightModels, GradientsAreThoseOfFiniteDifferences) {
    for (const LightKind kind : {LightKind::physical, LightKind::texels}) {
        const auto light = begin(kind, "sunset");
        const at::Tensor weights = at::linspace(0.5, 1.5, 6 * 16 * 16 * 3).view({6, 16, 16, 3});
        const auto loss = [&] {
            return (light->cube(16).log1p() * weights).sum() + light->regularization();
        };
        at::Tensor parameter = light->parameters()[0];
        {
            // At the start the regularisation is flat, so the parameters are moved away from it.
            const at::NoGradGuard no_grad;
            parameter.add_(0.1);
        }
        loss().backward();
        const at::Tensor gradient = parameter.grad().flatten();
        const at::NoGradGuard no_grad;
        at::Tensor flat = parameter.view(-1);
        // For the physical light, all parameters are tested except exposure and the sun's warmth,
        // which also drive constants (physical_light.h). For the texels, a few are tested.
        const std::vector<int> indices = parameter.numel() == 8
                                             ? std::vector<int>{1, 3, 4, 5, 6, 7}
                                             : std::vector<int>{300, 1500, 4000, 6100};
        for (const int i : indices) {
            constexpr float step = 5e-3f;
            const float at = flat[i].item<float>();
            flat[i] = at + step;
            const double above = loss().item<double>();
            flat[i] = at - step;
            const double below = loss().item<double>();
            flat[i] = at;
            const double expected = (above - below) / (2 * step);
            EXPECT_NEAR(gradient[i].item<float>(), expected, 0.05 * std::abs(expected) + 0.3)
                << static_cast<int>(kind) << " " << i;
        }
    }
}

TEST(LightModels, WarmerSunsStandLower) {
    PhysicalLight light(make_light_preset("noon", 64), {});
    const PhysicalValues before = light.values();
    {
        const at::NoGradGuard no_grad;
        light.parameters()[0][2] += 3;
    }
    EXPECT_GT(light.values().sun_warmth, before.sun_warmth + 50);
    EXPECT_LT(light.values().sun.elevation, 0.5f * before.sun.elevation);
    EXPECT_LT(*describe_light(light.image(64)).color_temperature, 5000);
}

TEST(LightModels, RefusesBlackLights) {
    EXPECT_THROW(make_light_model(Image(32, 16, 3), {}), InputError);
}

}  // namespace
}  // namespace item3d
