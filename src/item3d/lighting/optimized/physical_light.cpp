#include "item3d/lighting/optimized/physical_light.h"

#include "item3d/lighting/optimized/directions.h"
#include "item3d/render/image_tensor.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace item3d {
namespace {

enum Number { exposure, sun_share, sun_warmth, sky_warmth, ground, glow, elevation, azimuth };
constexpr std::int64_t number_count = 8;

struct Bounds {
    float low, high;
};
/// Ranges of all parameters but the azimuth, which is unbounded. The units are stops, a share,
/// mired, mired, two ratios, and degrees.
constexpr std::array<Bounds, 7> bounds{
    {{-3, 0.75f}, {0.03f, 0.85f}, {-110, 330}, {-110, 250}, {0.05f, 1}, {0, 3}, {3, 85}}};
/// Weights by which the regularisation holds each parameter at its initial value. They are large
/// for the sky's warmth, so that the sun becomes warm instead, and for parameters that few
/// sentences mention.
constexpr std::array<float, number_count> firmness{3, 1, 2, 4, 1, 0.3f, 10, 10};
/// Range of exposure for a warm light. A light as warm as a low sun counts as day. A dark light
/// that is not warm counts as night and gets the cold colour of moonlight. Otherwise a small prior,
/// for which most evenings are dark, turns evenings into nights, and makes nights grey.
constexpr Bounds warm_exposure{-1.2f, 0.75f};
constexpr float dusk = -1.3f;  ///< exposure of a dark light, in stops
constexpr float moonlight_mired = -60;
/// Warmth, in mired from white, at which sunlight's path through the air is twice the shortest.
constexpr float warmth_of_low_sun = 40;
/// Minimum share of the sun if words fix its direction, so that the sun is visible.
constexpr float min_spoken_share = 0.25f;

constexpr float lobe_radius = 5 * pi / 180;  ///< a few texels of the cube in the optimisation
constexpr float horizon_softness = 0.06f;
constexpr float glow_height = 0.25f;
constexpr float white_mired = 1e6f / 6504;
/// Natural logarithm of RGB per mired: c2 / lambda at 610, 550 and 465 nm, relative to green.
constexpr std::array<float, 3> log_color_per_mired{2.573e-3f, 0.0f, -4.782e-3f};

at::Tensor bounded(const at::Tensor& number, Bounds range) {
    return range.low + (range.high - range.low) * at::sigmoid(number);
}

float unbounded(float value, Bounds range) {
    // The ends of the range have no finite logit. The clamp also keeps some slope near them.
    const float part = std::clamp((value - range.low) / (range.high - range.low), 0.05f, 0.95f);
    return std::log(part / (1 - part));
}

/// Returns the colour, [3] linear RGB of luminance 1.
at::Tensor color_of(const at::Tensor& mired_from_white) {
    const at::Tensor slope =
        at::tensor({log_color_per_mired[0], log_color_per_mired[1], log_color_per_mired[2]});
    const at::Tensor color = at::exp(mired_from_white * slope);
    const at::Tensor weights = at::tensor({0.2126f, 0.7152f, 0.0722f});
    return color / (color * weights).sum();
}

}  // namespace

PhysicalLight::PhysicalLight(const Image& light, const LightModelOptions& options)
    : held_(options.from) {
    const LightDescription description = describe_light(light);
    const SkyAngles dominant = held_ ? *held_ : to_sky_angles(description.dominant_direction);
    start_azimuth_ = dominant.azimuth * pi / 180;
    const float warmth =
        description.color_temperature
            ? static_cast<float>(1e6 / *description.color_temperature) - white_mired
            : 0.0f;
    at::Tensor numbers = at::zeros({number_count});
    const auto set = [&](Number number, float value) {
        numbers[number] = unbounded(value, bounds[number]);
    };
    set(exposure, static_cast<float>(std::log2(description.peak_irradiance_over_pi)));
    set(sun_share, 0.5f * static_cast<float>(description.directionality));
    set(sun_warmth, warmth);
    set(sky_warmth, warmth);
    set(ground, 0.4f);
    set(glow, 0.5f);
    set(elevation, dominant.elevation);
    start_ = numbers.clone();
    numbers_ = numbers.set_requires_grad(true);
}

at::Tensor PhysicalLight::sun_direction() const {
    if (held_) {
        const Vec3 d = to_direction(*held_);
        return at::tensor({d.x, d.y, d.z});
    }
    const at::Tensor warmth = bounded(numbers_[sun_warmth], bounds[sun_warmth]);
    const at::Tensor air = 1 + at::softplus(warmth / warmth_of_low_sun - 0.5f);
    const at::Tensor up = bounded(numbers_[elevation], bounds[elevation]) / air * (pi / 180);
    const at::Tensor around = start_azimuth_ + numbers_[azimuth];
    return at::stack({up.cos() * around.sin(), up.sin(), -(up.cos() * around.cos())});
}

at::Tensor PhysicalLight::radiance(const at::Tensor& directions) const {
    const auto value = [&](Number number) { return bounded(numbers_[number], bounds[number]); };
    const at::Tensor sun = sun_direction();
    // These quantities are detached, because they must not contribute to the parameters' gradients.
    const at::Tensor warm = at::sigmoid((value(sun_warmth) - 50) / 20).detach();
    const at::Tensor dark = at::sigmoid((dusk - value(exposure)) / 0.3f).detach();
    const at::Tensor moonlight = (1 - warm) * dark * moonlight_mired;
    const at::Tensor sun_color = color_of(value(sun_warmth) + moonlight);
    const at::Tensor sky_color = color_of(value(sky_warmth) + moonlight);
    at::Tensor share = value(sun_share);
    if (held_) share = min_spoken_share + (1 - min_spoken_share) * share;

    const at::Tensor facing = (directions * sun).sum(-1, true);
    const at::Tensor up = directions.select(-1, 1).unsqueeze(-1);
    // Share of the sky's light near the horizon, which has a long path through the air.
    const at::Tensor low =
        at::exp(-up.clamp_min(0) / glow_height) * (0.25f + 0.1875f * (1 + facing).square());
    const at::Tensor sky = (sky_color * (1 - low) + sun_color * low) * (1 + value(glow) * low);
    const at::Tensor earth =
        value(ground) * (0.5f * sky_color + 0.5f * sun_color) * at::ones_like(up);
    const at::Tensor above = at::sigmoid(up / horizon_softness);
    const at::Tensor ambient = above * sky + (1 - above) * earth;

    // The lobe is a Gaussian in the angle, normalised to a mean radiance of 1 over the sphere.
    const float spread = 1 / (lobe_radius * lobe_radius);
    const at::Tensor lobe = (4 * spread) * at::exp(2 * spread * (facing - 1)) * sun_color;
    const at::Tensor stops =
        warm * bounded(numbers_[exposure], warm_exposure) + (1 - warm) * value(exposure);
    return at::exp2(stops) / (1 + 3 * share) * ((1 - share) * ambient + share * lobe);
}

at::Tensor PhysicalLight::cube(int size) const {
    return radiance(cube_directions(size));
}

Image PhysicalLight::image(int height) const {
    const at::NoGradGuard no_grad;
    return to_image(radiance(map_directions(height)));
}

at::Tensor PhysicalLight::regularization() const {
    const at::Tensor weights = at::tensor(std::vector<float>(firmness.begin(), firmness.end()));
    return (weights * (numbers_ - start_).square()).sum();
}

NamedTensors PhysicalLight::named_parameters() const {
    return {{"numbers", numbers_}};
}

PhysicalValues PhysicalLight::values() const {
    const at::NoGradGuard no_grad;
    const auto value = [&](Number number) {
        return bounded(numbers_[number], bounds[number]).item<float>();
    };
    const at::Tensor d = sun_direction();
    PhysicalValues values{value(exposure),
                          value(sun_share),
                          value(sun_warmth),
                          value(sky_warmth),
                          value(ground),
                          value(glow),
                          {}};
    values.sun = to_sky_angles(Vec3(d[0].item<float>(), d[1].item<float>(), d[2].item<float>()));
    if (held_) values.sun_share = min_spoken_share + (1 - min_spoken_share) * values.sun_share;
    return values;
}

}  // namespace item3d
