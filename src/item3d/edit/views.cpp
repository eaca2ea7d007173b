#include "item3d/edit/views.h"

#include "item3d/core/error.h"
#include "item3d/core/random.h"
#include "item3d/io/load_light.h"
#include "item3d/lighting/environment.h"
#include "item3d/metrics/color.h"

#include <array>
#include <cmath>

namespace item3d {
namespace {

constexpr float degrees = pi / 180.0f;
constexpr int light_rotations = 6;

Random iteration_random(std::uint64_t seed, IndexedStream stream, std::int64_t iteration) {
    return Random(mix_bits(seed) ^ static_cast<std::uint64_t>(iteration), stream);
}

Vec3 linear_background(const std::string& text) {
    const Vec3 encoded = parse_color(text);
    return Vec3(srgb_to_linear(encoded.x), srgb_to_linear(encoded.y), srgb_to_linear(encoded.z));
}

}  // namespace

std::vector<Camera> sample_cameras(const BoundingSphere& sphere, int count, std::uint64_t seed,
                                   std::int64_t iteration) {
    Random random = iteration_random(seed, IndexedStream::cameras, iteration);
    std::vector<Camera> cameras;
    for (int i = 0; i < count; ++i) {
        const auto azimuth = static_cast<float>(random.uniform(0, 2 * pi));
        const auto elevation = static_cast<float>(random.uniform(-10, 45)) * degrees;
        const auto field_of_view = static_cast<float>(random.uniform(25.7, 45)) * degrees;
        const auto fill = static_cast<float>(random.uniform(0.8, 1.05));
        const float distance = sphere.radius / (fill * std::sin(0.5f * field_of_view));
        const Vec3 jitter =
            0.05f * sphere.radius *
            Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        Camera camera =
            orbit_camera(sphere.center + jitter, distance, azimuth, elevation, field_of_view);
        camera.near_plane = std::max(0.02f * sphere.radius, distance - 1.5f * sphere.radius);
        camera.far_plane = distance + 1.5f * sphere.radius;
        cameras.push_back(camera);
    }
    return cameras;
}

at::Tensor sample_backgrounds(const std::string& background, int count, std::uint64_t seed,
                              std::int64_t iteration) {
    at::Tensor colors = at::empty({count, 3});
    const Vec3 named = background == "vary" ? Vec3(0) : linear_background(background);
    Random random = iteration_random(seed, IndexedStream::backgrounds, iteration);
    for (int i = 0; i < count; ++i) {
        const Vec3 color = background == "vary"
                               ? Vec3(srgb_to_linear(static_cast<float>(random.uniform(0.5, 1.0))))
                               : named;
        for (int c = 0; c < 3; ++c)
            colors[i][c] = color[c];
    }
    return colors;
}

LightRig::LightRig(const std::string& light, LightAugment variation, int cube_size,
                   at::Device device)
    : cube_size_(cube_size), device_(device) {
    const auto add = [&](Source source, int rotations, float first) {
        for (int i = 0; i < rotations; ++i)
            lights_.push_back(
                {sources_.size(),
                 first + 360.0f * static_cast<float>(i) / static_cast<float>(rotations),
                 {}});
        sources_.push_back(std::move(source));
    };
    add({light, load_light(light)}, variation == LightAugment::off ? 1 : light_rotations, 0);
    if (variation != LightAugment::all) return;
    exposure_range_ = 0.5f;
    // Only white lights are added, because in the light of a sunset white surfaces look orange to
    // the prior.
    for (const char* preset : {"studio", "overcast", "noon"})
        if (preset != light) add({preset, {}}, light_rotations / 2, 30);
}

const EnvironmentLight& LightRig::at(std::size_t index) {
    Light& light = lights_[index];
    if (light.prefiltered) return *light.prefiltered;
    Source& source = sources_[light.source];
    if (!source.image) source.image = make_light_preset(source.preset);
    light.prefiltered =
        prefilter(adjust_light(*source.image, light.turn, 0.0f), cube_size_, device_);
    return *light.prefiltered;
}

const EnvironmentLight& LightRig::studio() {
    if (sources_.front().preset == "studio") return front();
    if (!studio_) studio_ = prefilter(make_light_preset("studio"), cube_size_, device_);
    return *studio_;
}

ViewLight LightRig::pick(std::uint64_t seed, std::int64_t iteration) {
    Random random = iteration_random(seed, IndexedStream::lights, iteration);
    const EnvironmentLight& light =
        at(static_cast<std::size_t>(random.index(static_cast<std::int64_t>(lights_.size()))));
    if (exposure_range_ == 0) return {light};
    const double stops = random.uniform(-exposure_range_, exposure_range_);
    return {light, static_cast<float>(std::exp2(stops))};
}

}  // namespace item3d
