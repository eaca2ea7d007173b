#include "item3d/edit/views.h"

#include <array>
#include <cmath>
#include <cstdio>

#include "item3d/core/error.h"
#include "item3d/core/random.h"
#include "item3d/scene/environment.h"

namespace item3d {
namespace {

constexpr float degrees = pi / 180.0f;
constexpr int light_rotations = 6;

// Streams of the edit's seed; the guidance uses stream 1.
enum Stream : std::uint64_t { camera_stream = 2, background_stream = 3, light_stream = 4 };

Random iteration_random(std::uint64_t seed, Stream stream, std::int64_t iteration) {
    return Random(mix_bits(seed) ^ static_cast<std::uint64_t>(iteration), stream);
}

}  // namespace

BoundingSphere bounding_sphere(const Model& model) {
    const auto [low, high] = model.bounds();
    BoundingSphere sphere{0.5f * (low + high), 0.0f};
    for (const Primitive& primitive : model.primitives) {
        for (const Vec3& position : primitive.positions) {
            sphere.radius = std::max(sphere.radius, glm::length(position - sphere.center));
        }
    }
    return sphere;
}

std::vector<Camera> sample_cameras(const BoundingSphere& sphere, int count, std::uint64_t seed,
                                   std::int64_t iteration) {
    Random random = iteration_random(seed, camera_stream, iteration);
    std::vector<Camera> cameras;
    for (int i = 0; i < count; ++i) {
        const auto azimuth = static_cast<float>(random.uniform(0, 2 * pi));
        const auto elevation = static_cast<float>(random.uniform(-10, 45)) * degrees;
        const auto field_of_view = static_cast<float>(random.uniform(25.7, 45)) * degrees;
        const auto fill = static_cast<float>(random.uniform(0.8, 1.05));
        const float distance = sphere.radius / (fill * std::sin(0.5f * field_of_view));
        const Vec3 jitter = 0.05f * sphere.radius *
                            Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        Camera camera =
            orbit_camera(sphere.center + jitter, distance, azimuth, elevation, field_of_view);
        camera.near_plane = std::max(0.02f * sphere.radius, distance - 1.5f * sphere.radius);
        camera.far_plane = distance + 1.5f * sphere.radius;
        cameras.push_back(camera);
    }
    return cameras;
}

Vec3 parse_color(const std::string& text) {
    static const std::vector<std::pair<std::string, Vec3>> names = {
        {"white", {255, 255, 255}}, {"black", {0, 0, 0}},      {"gray", {128, 128, 128}},
        {"grey", {128, 128, 128}},  {"red", {255, 0, 0}},      {"green", {0, 128, 0}},
        {"blue", {0, 0, 255}},      {"yellow", {255, 255, 0}}, {"orange", {255, 165, 0}},
        {"cyan", {0, 255, 255}},    {"purple", {128, 0, 128}}, {"pink", {255, 192, 203}},
        {"brown", {150, 75, 0}}};
    const auto linear = [](Vec3 bytes) {
        return Vec3(srgb_to_linear(bytes.x / 255), srgb_to_linear(bytes.y / 255),
                    srgb_to_linear(bytes.z / 255));
    };
    for (const auto& [name, bytes] : names) {
        if (text == name) return linear(bytes);
    }
    std::array<int, 3> value{};
    char rest = 0;
    const bool parsed =
        (text.size() == 7 &&
         std::sscanf(text.c_str(), "#%2x%2x%2x%c", reinterpret_cast<unsigned*>(&value[0]),
                     reinterpret_cast<unsigned*>(&value[1]), reinterpret_cast<unsigned*>(&value[2]),
                     &rest) == 3) ||
        std::sscanf(text.c_str(), "%d,%d,%d%c", &value[0], &value[1], &value[2], &rest) == 3;
    for (const int channel : value) {
        if (!parsed || channel < 0 || channel > 255) {
            throw InputError("--background", "'" + text + "' is not a colour",
                             "give a name as white, #rrggbb, or r,g,b in 0 to 255");
        }
    }
    return linear(Vec3(value[0], value[1], value[2]));
}

torch::Tensor sample_backgrounds(const std::string& background, int count, std::uint64_t seed,
                                 std::int64_t iteration) {
    torch::Tensor colors = torch::empty({count, 3});
    Random random = iteration_random(seed, background_stream, iteration);
    for (int i = 0; i < count; ++i) {
        const Vec3 color = background == "vary"
                               ? Vec3(srgb_to_linear(static_cast<float>(random.uniform(0.5, 1.0))))
                               : parse_color(background);
        for (int c = 0; c < 3; ++c) colors[i][c] = color[c];
    }
    return colors;
}

LightRig::LightRig(const std::string& light, int cube_size, torch::Device device) {
    const Image image = load_light(light);
    for (int i = 0; i < light_rotations; ++i) {
        const float turn = 360.0f * static_cast<float>(i) / light_rotations;
        lights_.push_back(prefilter(adjust_light(image, turn, 0.0f), cube_size, device));
    }
}

const EnvironmentLight& LightRig::pick(std::uint64_t seed, std::int64_t iteration) const {
    Random random = iteration_random(seed, light_stream, iteration);
    return lights_[static_cast<std::size_t>(random.index(light_rotations))];
}

}  // namespace item3d
